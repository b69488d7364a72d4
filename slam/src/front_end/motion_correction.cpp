#include "front_end/motion_correction.h"

#include <cmath>

namespace hqslam::slam {

/// With the axis a, the angle A and the linear part v of the velocity, and u = t A:
///   R(t) p = p + sin u a x p + (1 - cos u) a x (a x p)
///   x(t)   = t v + (1 - cos u) / A a x v + (t - sin u / A) a x (a x v).
MotionCorrection::MotionCorrection(const ScanMotion& motion)
    : angle_rad_(static_cast<float>(motion.velocity.angular.norm())),
      linear_m_(motion.velocity.linear.cast<float>()),
      acceleration_mps2_(motion.acceleration.linear.cast<float>()),
      angular_acceleration_rad_per_s2_(motion.acceleration.angular.cast<float>()) {
  if (angle_rad_ < kNoTurn_rad) return;
  axis_ = motion.velocity.angular.cast<float>() / angle_rad_;
  across_m_ = axis_.cross(linear_m_);
  twice_across_m_ = axis_.cross(across_m_);
}

Eigen::Vector3f MotionCorrection::operator()(const FeaturePoint& point) const {
  const float time_s = point.time_offset_s;
  if (time_s == 0.0F) return point.point_m;
  const Eigen::Vector3f moved_m = by_velocity(point.point_m, time_s);
  return moved_m + 0.5F * time_s * time_s *
                       (acceleration_mps2_ + angular_acceleration_rad_per_s2_.cross(moved_m));
}

Eigen::Vector3f MotionCorrection::by_velocity(const Eigen::Vector3f& p_m, float time_s) const {
  if (angle_rad_ < kNoTurn_rad) return p_m + time_s * linear_m_;
  const float half_sine = std::sin(0.5F * time_s * angle_rad_);
  const float half_cosine = std::cos(0.5F * time_s * angle_rad_);
  const float sine = 2.0F * half_sine * half_cosine;
  const float versine = 2.0F * half_sine * half_sine;
  const Eigen::Vector3f aside_m = axis_.cross(p_m);
  return p_m + sine * aside_m + versine * axis_.cross(aside_m) + time_s * linear_m_ +
         (versine / angle_rad_) * across_m_ + (time_s - sine / angle_rad_) * twice_across_m_;
}

std::vector<Eigen::Vector3f> motion_corrected(const std::vector<FeaturePoint>& points,
                                              const ScanMotion& motion) {
  const MotionCorrection corrected(motion);
  std::vector<Eigen::Vector3f> result(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) result[i] = corrected(points[i]);
  return result;
}

}  // namespace hqslam::slam
