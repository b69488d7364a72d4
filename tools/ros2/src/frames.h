#pragma once

#include <Eigen/Core>
#include <optional>

#include "hqslam/core/pose.h"
#include "hqslam/core/trajectory.h"
#include "hqslam/slam/saved_map.h"
#include "hqslam/slam/slam.h"

namespace hqslam_ros {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Where a robot is after a scan, in the frames of REP 105, and how it moves.
struct RobotState {
  hqslam::Pose T_map_base = hqslam::Pose::Identity();   ///< jumps where a loop is closed
  hqslam::Pose T_odom_base = hqslam::Pose::Identity();  ///< never jumps, drifts
  /// As messages have them: of position and of rotations about the axes of the frame (map, odom).
  Matrix6 map_covariance = Matrix6::Zero();
  Matrix6 odom_covariance = Matrix6::Zero();
  hqslam::Twist velocity;  ///< of base, in base, per second
  Matrix6 velocity_covariance = Matrix6::Zero();
};

/// From SLAM's poses of the LiDAR to the frames of a robot that carries it.
///
/// map: that of a given map; otherwise base where the first scan was taken, turned level. odom:
/// base there. From scan to scan odom moves as the corrected path does where both scans were found
/// in the map, and otherwise by the odometry; so closed loops, and places found again, are in
/// map -> odom alone. Its covariance grows as that in the map does, but loops take nothing from it.
class RobotFrames {
 public:
  RobotFrames(const hqslam::Pose& T_base_lidar, bool is_map_given);

  /// In: what SLAM reported of a scan, and its path so far, that scan's pose included.
  RobotState next(const hqslam::slam::ScanReport& report, const hqslam::Trajectory& path);

  /// Takes points of SLAM's map, and lidar poses in it, into the robot's.
  const hqslam::Pose& T_map_slam() const { return T_map_slam_; }

 private:
  hqslam::Pose T_base_lidar_;
  hqslam::Pose T_map_slam_;
  std::optional<hqslam::slam::ScanReport> last_;
  hqslam::Pose T_odom_base_ = hqslam::Pose::Identity();
  Matrix6 odom_covariance_ = Matrix6::Zero();  ///< of e in T exp(e), T = T_odom_lidar
};

/// T_map_odom, which is broadcast to tf, whatever publishes odom.
hqslam::Pose T_map_odom(const hqslam::Pose& T_map_base, const hqslam::Pose& T_odom_base);

/// A saved map in another frame, which differs from its own by a shift and a turn about z.
hqslam::slam::SavedMap moved(hqslam::slam::SavedMap map, const hqslam::Pose& T_other_map);

}  // namespace hqslam_ros
