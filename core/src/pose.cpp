#include "hqslam/core/pose.h"

#include <algorithm>
#include <cmath>

namespace hqslam {

Pose pose_from_xyz_rpy(const Eigen::Vector3d& translation_m, double roll_rad, double pitch_rad,
                       double yaw_rad) {
  Pose pose = Pose::Identity();
  pose.linear() = (Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  pose.translation() = translation_m;
  return pose;
}

Eigen::Vector3d roll_pitch_yaw_rad(const Pose& pose) {
  const Eigen::Matrix3d& R = pose.linear();
  const double pitch_rad = std::asin(std::clamp(-R(2, 0), -1.0, 1.0));
  return {std::atan2(R(2, 1), R(2, 2)), pitch_rad, std::atan2(R(1, 0), R(0, 0))};
}

double rotation_angle_rad(const Pose& pose) {
  const Eigen::Quaterniond q(pose.linear());
  return 2.0 * std::atan2(q.vec().norm(), std::abs(q.w()));
}

Pose interpolate(const Pose& a, const Pose& b, double fraction) {
  // Angle and axis rather than slerp, which Eigen does not extrapolate.
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(a.linear().transpose() * b.linear()));
  Pose pose = Pose::Identity();
  pose.linear() =
      a.linear() * Eigen::AngleAxisd(fraction * turn.angle(), turn.axis()).toRotationMatrix();
  pose.translation() = a.translation() + fraction * (b.translation() - a.translation());
  return pose;
}

Pose orthonormalized(const Pose& pose) {
  Pose result = pose;
  result.linear() = Eigen::Affine3d(pose).rotation();  // the nearest rotation matrix, by SVD
  return result;
}

}  // namespace hqslam
