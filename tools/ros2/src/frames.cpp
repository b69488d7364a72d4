#include "frames.h"

#include "hqslam/slam/status.h"

namespace hqslam_ros {

namespace {

using hqslam::Pose;
using hqslam::slam::LoopStatus;
using hqslam::slam::ScanReport;

/// What a change of frames does to a twist or an error (linear, angular).
Matrix6 adjoint(const Pose& pose) {
  const Eigen::Vector3d t = pose.translation();
  Eigen::Matrix3d cross;
  cross << 0.0, -t.z(), t.y(), t.z(), 0.0, -t.x(), -t.y(), t.x(), 0.0;
  Matrix6 result = Matrix6::Zero();
  result.topLeftCorner<3, 3>() = result.bottomRightCorner<3, 3>() = pose.linear();
  result.topRightCorner<3, 3>() = cross * pose.linear();
  return result;
}

/// A covariance that is infinite stays so, whichever way one looks.
Matrix6 transformed(const Matrix6& change, const Matrix6& covariance) {
  return covariance.allFinite() ? Matrix6(change * covariance * change.transpose()) : covariance;
}

/// From the covariance of e in T exp(e), T = T_frame_lidar, to that of base in the frame's axes.
Matrix6 in_axes_of_frame(const Matrix6& covariance, const Pose& T_base_lidar,
                         const Pose& T_frame_base) {
  const Pose turn(T_frame_base.linear());
  return transformed(adjoint(turn * T_base_lidar), covariance);
}

Pose step_of(const ScanReport& last, const ScanReport& report, const hqslam::Trajectory& path) {
  const bool both_registered = hqslam::slam::is_registered(last.mapping_status) &&
                               hqslam::slam::is_registered(report.mapping_status);
  if (!both_registered) return last.T_odom_sensor.inverse() * report.T_odom_sensor;
  return path[path.size() - 2].T_map_sensor.inverse() * path.back().T_map_sensor;
}

/// By how much less is known than at the scan before; nothing where a loop added to it.
Matrix6 growth(const ScanReport& last, const ScanReport& report, const Matrix6& carry) {
  const bool is_loop =
      report.loop.status == LoopStatus::kAgrees || report.loop.status == LoopStatus::kClosed;
  if (is_loop || !last.covariance.allFinite() || !report.covariance.allFinite()) {
    return Matrix6::Zero();
  }
  return report.covariance - transformed(carry, last.covariance);
}

/// SLAM's map begins at the LiDAR, level; base is level there.
Pose start_of(const Pose& T_base_lidar) {
  const double yaw_rad = hqslam::roll_pitch_yaw_rad(T_base_lidar).z();
  return hqslam::pose_from_xyz_rpy(T_base_lidar.translation(), 0.0, 0.0, yaw_rad);
}

}  // namespace

RobotFrames::RobotFrames(const Pose& T_base_lidar, bool is_map_given)
    : T_base_lidar_(T_base_lidar),
      T_map_slam_(is_map_given ? Pose::Identity() : start_of(T_base_lidar)) {}

RobotState RobotFrames::next(const ScanReport& report, const hqslam::Trajectory& path) {
  const Pose T_lidar_base = T_base_lidar_.inverse();
  if (last_) {
    const Pose step = step_of(*last_, report, path);
    const Matrix6 carry = adjoint(step.inverse());
    odom_covariance_ = transformed(carry, odom_covariance_) + growth(*last_, report, carry);
    T_odom_base_ = hqslam::orthonormalized(T_odom_base_ * T_base_lidar_ * step * T_lidar_base);
  }
  last_ = report;

  RobotState result;
  result.T_map_base = T_map_slam_ * report.T_map_sensor * T_lidar_base;
  result.T_odom_base = T_odom_base_;
  result.map_covariance = in_axes_of_frame(report.covariance, T_base_lidar_, result.T_map_base);
  result.odom_covariance = in_axes_of_frame(odom_covariance_, T_base_lidar_, T_odom_base_);
  const Matrix6 to_base = adjoint(T_base_lidar_);
  Eigen::Matrix<double, 6, 1> velocity;
  velocity << report.velocity.linear, report.velocity.angular;
  velocity = to_base * velocity;
  result.velocity = {velocity.head<3>(), velocity.tail<3>()};
  result.velocity_covariance = transformed(to_base, report.velocity_covariance);
  return result;
}

Pose T_map_odom(const Pose& T_map_base, const Pose& T_odom_base) {
  return hqslam::orthonormalized(T_map_base * T_odom_base.inverse());
}

hqslam::slam::SavedMap moved(hqslam::slam::SavedMap map, const Pose& T_other_map) {
  const Eigen::Isometry3f T_other_map_f = T_other_map.cast<float>();
  for (auto* kind : {&map.edges_m, &map.posts_m, &map.planes_m}) {
    for (Eigen::Vector3f& point_m : *kind) point_m = T_other_map_f * point_m;
  }
  for (hqslam::slam::SavedPlace& place : map.places) {
    place.T_map_sensor = T_other_map * place.T_map_sensor;
  }
  return map;
}

}  // namespace hqslam_ros
