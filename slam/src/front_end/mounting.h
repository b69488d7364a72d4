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

/// Converts between the sensor as it is mounted and the upright sensor, with the ground below, that
/// all later stages expect: the real one turned about its own origin. `level` is its frame.
///
/// A scan of a sensor that hangs upside down is turned as a whole, rows and columns, so that row 0
/// is the highest beam again. The remaining tilt is taken out of the points alone; rows are then
/// tilted cones.
class Mounting {
 public:
  Mounting(const MountingOptions& options, const SensorModel& sensor);

  /// Its rows are ordered from above to below, as those of clouds from level().
  const SensorModel& upright_sensor() const { return upright_sensor_; }
  /// A direction of the level frame, the vertical by default, in the frame of that sensor, which is
  /// tilted as the real one is.
  Eigen::Vector3d up_of_upright_sensor(const Eigen::Vector3d& up = Eigen::Vector3d::UnitZ()) const;

  /// Compares the stated mounting with the ground in a scan of the sensor, whose pixels must be
  /// sound, and takes the ground's where it leans by more than 5 degrees against the stated one or
  /// MountingOptions::estimated asks for it. The ground is the plane, tilted by at most 30 degrees,
  /// with most of the candidate points within 25 m, one per 0.5 m (RANSAC, then least squares).
  /// Returns whether there was one. Motion along the ground does not matter.
  bool correct_from_ground(const OrganizedCloud& cloud);
  /// Whether correct_from_ground() has found the ground in a scan.
  bool is_compared() const { return is_compared_; }

  /// The scan in the level frame; nothing where the two frames are the same.
  std::optional<OrganizedCloud> level(const OrganizedCloud& cloud) const;

  const Eigen::Matrix3d& turn_to_level() const { return R_level_sensor_; }
  /// The stated mounting, or the estimated one if `estimated`.
  const MountingOptions& mounted() const { return mounted_; }
  /// The pose of the sensor from that of the level frame.
  Pose of_sensor(const Pose& T_map_level) const;
  /// The covariance of e in T exp(e) for the sensor; one that is not finite is returned unchanged.
  Matrix6 of_sensor(const Matrix6& covariance) const;
  /// A motion of the level frame in the frame of the sensor.
  Twist of_sensor(const Twist& motion) const;

 private:
  MountingOptions mounted_;
  bool is_always_estimated_;
  bool is_compared_ = false;
  Eigen::Matrix3d R_level_sensor_;
  bool is_upside_down_;
  SensorModel upright_sensor_;
};

/// mark_ground() for a scan in its sensor's own frame, in any orientation.
std::vector<std::uint8_t> mark_ground_of(const OrganizedCloud& cloud, const SensorModel& sensor,
                                         const Eigen::Vector3d& up_of_sensor);

}  // namespace hqslam::slam
