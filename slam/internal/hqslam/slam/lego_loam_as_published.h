#pragma once

#include <memory>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/core/trajectory.h"

namespace hqslam::slam {

/// LeGO-LOAM with the numbers and the defects of its published program: what `Slam` would be
/// without what the stages list under "Differs from LeGO-LOAM". For comparison only: it shows what
/// upsampled rows do for the system that papers on upsampling use. Source: Shan & Englot, IROS
/// 2018, and what is documented about their program.
///
/// In every scan: ground among the lowest rows, clusters, features judged by their smoothness in
/// metres alone, odometry in two times 25 steps of 5 % of a Gauss-Newton step, its search cut off
/// at as many points as the scan has features. Every fourth scan (at 10 Hz): matching with the map
/// of the keyframes within 50 m, planar points weighed by their distance from the map's origin.
/// The pose of a scan is the odometry's, moved by what the last matching corrected. Every row of a
/// upsampled scan is used alike: the system knows nothing of computed rows.
///
/// Differs from the program: no loop closing (its default is off, too), no inertial sensor; one
/// thread and every scan in turn, so nothing is dropped and the result is the same in every run;
/// row and column are the image's; a pose is given for the scan's stamp, the middle of the sweep,
/// instead of its end; angles are those of the sensor's axes instead of a camera's; entries of its
/// arrays that it reads before they are written count as 0; a last scan with too few features is
/// kept out of the search instead of leaving a search tree of another scan.
class LegoLoamAsPublished {
 public:
  /// Throws Error if the sensor is invalid.
  explicit LegoLoamAsPublished(const SensorModel& sensor);
  ~LegoLoamAsPublished();
  LegoLoamAsPublished(LegoLoamAsPublished&&) noexcept;  ///< moved from: only assign or destroy
  LegoLoamAsPublished& operator=(LegoLoamAsPublished&&) noexcept;

  /// Returns T_map_sensor at the stamp. Throws Error as Slam::process does.
  Pose process(const OrganizedCloud& cloud, double stamp_s);

  /// T_map_sensor of every scan so far, as it was when the scan was processed; the map's frame is
  /// the sensor's at the end of the first sweep.
  const Trajectory& trajectory() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace hqslam::slam
