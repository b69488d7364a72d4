#include "hqslam/core/pose.h"

#include <algorithm>
#include <cmath>

namespace hqslam {

namespace {

/// Below this angle the series are taken: their next terms are under 1e-16.
constexpr double kSmallAngle_rad = 1e-4;

/// (1 - cos a) / a^2 and (a - sin a) / a^3.
struct RotationSeries {
  double first;
  double second;
};

RotationSeries rotation_series(double angle_rad) {
  const double squared = angle_rad * angle_rad;
  if (angle_rad < kSmallAngle_rad) return {0.5 - squared / 24.0, 1.0 / 6.0 - squared / 120.0};
  const double half_sine = std::sin(0.5 * angle_rad);
  return {2.0 * half_sine * half_sine / squared,
          (angle_rad - std::sin(angle_rad)) / (squared * angle_rad)};
}

/// (1 - a / 2 cot(a / 2)) / a^2, what V inverse has before [w]^2.
double inverse_series(double angle_rad) {
  const double squared = angle_rad * angle_rad;
  if (angle_rad < kSmallAngle_rad) return 1.0 / 12.0 + squared / 720.0;
  const double half_rad = 0.5 * angle_rad;
  return (1.0 - half_rad * std::cos(half_rad) / std::sin(half_rad)) / squared;
}

}  // namespace

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

Pose exponential(const Twist& twist) {
  const Eigen::Vector3d& w = twist.angular;
  const Eigen::Vector3d& v = twist.linear;
  const double angle_rad = w.norm();
  Pose pose = Pose::Identity();
  if (angle_rad > 0.0) {
    pose.linear() = Eigen::AngleAxisd(angle_rad, w / angle_rad).toRotationMatrix();
  }
  const Eigen::Vector3d across = w.cross(v);
  const RotationSeries series = rotation_series(angle_rad);
  pose.translation() = v + series.first * across + series.second * w.cross(across);
  return pose;
}

Twist logarithm(const Pose& pose) {
  Eigen::Quaterniond q(pose.linear());
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();  // of half the angle
  const double angle_rad = 2.0 * std::atan2(sine, q.w());
  Twist twist;
  twist.angular = sine > 0.0 ? Eigen::Vector3d(angle_rad / sine * q.vec()) : 2.0 * q.vec();
  const Eigen::Vector3d& w = twist.angular;
  const Eigen::Vector3d& t = pose.translation();
  const Eigen::Vector3d across = w.cross(t);
  twist.linear = t - 0.5 * across + inverse_series(angle_rad) * w.cross(across);
  return twist;
}

Pose interpolate(const Pose& a, const Pose& b, double fraction) {
  const Pose pose = a * exponential(fraction * logarithm(a.inverse() * b));
  return fraction == 1.0 ? b : pose;
}

Pose orthonormalized(const Pose& pose) {
  Pose result = pose;
  result.linear() = Eigen::Affine3d(pose).rotation();  // the nearest rotation matrix, by SVD
  return result;
}

}  // namespace hqslam
