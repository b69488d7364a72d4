#include "front_end/motion_correction.h"

#include <cmath>

namespace hqslam::slam {

namespace {

/// A screw motion by any fraction of itself, in single precision.
///
/// With the axis a, the angle A and the linear part v of the twist, and u = f A:
///   R(f) p = p + sin u a x p + (1 - cos u) a x (a x p)
///   t(f)   = f v + (1 - cos u) / A a x v + (f - sin u / A) a x (a x v).
class Screw {
 public:
  explicit Screw(const Twist& twist)
      : angle_rad_(static_cast<float>(twist.angular.norm())),
        linear_m_(twist.linear.cast<float>()) {
    if (angle_rad_ < kNoTurn_rad) return;
    axis_ = twist.angular.cast<float>() / angle_rad_;
    across_m_ = axis_.cross(linear_m_);
    twice_across_m_ = axis_.cross(across_m_);
  }

  Eigen::Vector3f move(const Eigen::Vector3f& p_m, float fraction) const {
    if (angle_rad_ < kNoTurn_rad) return p_m + fraction * linear_m_;
    const float half_sine = std::sin(0.5F * fraction * angle_rad_);
    const float half_cosine = std::cos(0.5F * fraction * angle_rad_);
    const float sine = 2.0F * half_sine * half_cosine;
    const float versine = 2.0F * half_sine * half_sine;
    const Eigen::Vector3f aside_m = axis_.cross(p_m);
    return p_m + sine * aside_m + versine * axis_.cross(aside_m) + fraction * linear_m_ +
           (versine / angle_rad_) * across_m_ + (fraction - sine / angle_rad_) * twice_across_m_;
  }

 private:
  /// A turn by less moves nothing by a micrometre.
  static constexpr float kNoTurn_rad = 1e-8F;

  float angle_rad_;
  Eigen::Vector3f linear_m_;
  Eigen::Vector3f axis_ = Eigen::Vector3f::Zero();
  Eigen::Vector3f across_m_ = Eigen::Vector3f::Zero();
  Eigen::Vector3f twice_across_m_ = Eigen::Vector3f::Zero();
};

}  // namespace

std::vector<Eigen::Vector3f> motion_corrected(const std::vector<FeaturePoint>& points,
                                              const Twist& velocity) {
  const Screw screw(velocity);
  std::vector<Eigen::Vector3f> result(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const FeaturePoint& point = points[i];
    result[i] = point.time_offset_s == 0.0F ? point.point_m
                                            : screw.move(point.point_m, point.time_offset_s);
  }
  return result;
}

}  // namespace hqslam::slam
