#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "alignment/motion_state.h"
#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/pose.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/slam/options.h"

namespace hqslam::slam {

/// Between the sensor as it is mounted and the one that all stages after this expect: upright, with
/// the ground below. Their "sensor" is the real one turned about its own origin; `level` is its
/// frame.
///
/// A scan of a sensor that hangs upside down is turned as a whole, rows and columns: row 0 is
/// the highest beam again, and everything that follows is as if it stood upright. What tilt remains
/// is taken out of the points alone; rows are then cones that lean.
class Mounting {
 public:
  Mounting(const MountingOptions& options, const SensorModel& sensor);

  /// The rows from above to below, as clouds from level() have them.
  const SensorModel& upright_sensor() const { return upright_sensor_; }
  /// The vertical in that sensor's own frame, which leans if the real one does.
  Eigen::Vector3d up_of_upright_sensor() const;

  /// Looks for the ground in a scan of the sensor (whose pixels must be sound) and takes its
  /// vertical for that of the mounting. Of the planes that lean by at most 30 degrees from what was
  /// believed so far it is the one that most of what may be ground lies on, one point per 0.5 m,
  /// within 25 m (RANSAC, then least squares). Returns whether there was one. Motion along the
  /// ground does not matter.
  bool estimate(const OrganizedCloud& cloud);

  /// The scan in the level frame; nothing where the two frames are the same.
  std::optional<OrganizedCloud> level(const OrganizedCloud& cloud) const;

  const Eigen::Matrix3d& turn_to_level() const { return R_level_sensor_; }
  /// As given, or as estimated if `estimated`.
  const MountingOptions& mounted() const { return mounted_; }
  /// Where the sensor is, of where the level frame is.
  Pose of_sensor(const Pose& T_map_level) const;
  /// The covariance of e in T exp(e), the same way; one that is not finite stays as it is.
  Matrix6 of_sensor(const Matrix6& covariance) const;
  /// A motion of the level frame, in that of the sensor.
  Twist of_sensor(const Twist& motion) const;

 private:
  MountingOptions mounted_;
  Eigen::Matrix3d R_level_sensor_;
  bool is_upside_down_;
  SensorModel upright_sensor_;
};

/// mark_ground() of a scan in its sensor's own frame, whichever way up that is.
std::vector<std::uint8_t> mark_ground_of(const OrganizedCloud& cloud, const SensorModel& sensor,
                                         const Eigen::Vector3d& up_of_sensor);

}  // namespace hqslam::slam
