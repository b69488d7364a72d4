#include "front_end/motion_correction.h"

#include <cmath>

namespace hqslam::slam {

/// With the axis a, the angle A and the linear part v of the twist, and u = f A:
///   R(f) p = p + sin u a x p + (1 - cos u) a x (a x p)
///   t(f)   = f v + (1 - cos u) / A a x v + (f - sin u / A) a x (a x v).
MotionCorrection::MotionCorrection(const Twist& velocity)
    : angle_rad_(static_cast<float>(velocity.angular.norm())),
      linear_m_(velocity.linear.cast<float>()) {
  if (angle_rad_ < kNoTurn_rad) return;
  axis_ = velocity.angular.cast<float>() / angle_rad_;
  across_m_ = axis_.cross(linear_m_);
  twice_across_m_ = axis_.cross(across_m_);
}

Eigen::Vector3f MotionCorrection::operator()(const FeaturePoint& point) const {
  const Eigen::Vector3f& p_m = point.point_m;
  const float fraction = point.time_offset_s;
  if (fraction == 0.0F) return p_m;
  if (angle_rad_ < kNoTurn_rad) return p_m + fraction * linear_m_;
  const float half_sine = std::sin(0.5F * fraction * angle_rad_);
  const float half_cosine = std::cos(0.5F * fraction * angle_rad_);
  const float sine = 2.0F * half_sine * half_cosine;
  const float versine = 2.0F * half_sine * half_sine;
  const Eigen::Vector3f aside_m = axis_.cross(p_m);
  return p_m + sine * aside_m + versine * axis_.cross(aside_m) + fraction * linear_m_ +
         (versine / angle_rad_) * across_m_ + (fraction - sine / angle_rad_) * twice_across_m_;
}

std::vector<Eigen::Vector3f> motion_corrected(const std::vector<FeaturePoint>& points,
                                              const Twist& velocity) {
  const MotionCorrection corrected(velocity);
  std::vector<Eigen::Vector3f> result(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) result[i] = corrected(points[i]);
  return result;
}

}  // namespace hqslam::slam
