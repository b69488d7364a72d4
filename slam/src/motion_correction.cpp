#include "hqslam/slam/motion_correction.h"

#include <cmath>

namespace hqslam::slam {

std::vector<Eigen::Vector3f> motion_corrected(const std::vector<FeaturePoint>& points,
                                              const SensorMotion& motion) {
  const Eigen::AngleAxisd turn(motion.T_begin_end.linear());
  const Eigen::Vector3f axis = turn.axis().cast<float>();
  const auto angle_rad = static_cast<float>(turn.angle());
  const Eigen::Vector3f translation_m = motion.T_begin_end.translation().cast<float>();
  const auto inverse_duration = static_cast<float>(1.0 / motion.duration_s);
  std::vector<Eigen::Vector3f> result(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float fraction = points[i].time_offset_s * inverse_duration;
    if (fraction == 0.0F) {
      result[i] = points[i].point_m;
      continue;
    }
    // Rodrigues' rotation by fraction * angle.
    const float sine = std::sin(fraction * angle_rad);
    const float cosine = std::cos(fraction * angle_rad);
    const Eigen::Vector3f& p = points[i].point_m;
    result[i] = cosine * p + sine * axis.cross(p) + ((1.0F - cosine) * axis.dot(p)) * axis +
                fraction * translation_m;
  }
  return result;
}

}  // namespace hqslam::slam
