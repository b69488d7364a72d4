#include "imu/even_turning.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace hqslam::slam {

namespace {

constexpr std::size_t kKnots = 65;

Eigen::Quaterniond quaternion_of(const Eigen::Vector3d& turn_rad) {
  const double angle_rad = turn_rad.norm();
  if (angle_rad < 1e-12) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, turn_rad / angle_rad));
}

Eigen::Vector3d logarithm_of(const Eigen::Quaterniond& turn) {
  const Eigen::AngleAxisd angle_axis(turn);
  return angle_axis.angle() * angle_axis.axis();
}

/// The rotation from the beginning of the scan to `time_s` after it.
Eigen::Quaterniond turn_until(const std::vector<ImuStep>& steps, const Eigen::Vector3d& bias,
                              double time_s) {
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  for (const ImuStep& step : steps) {
    const double duration_s = std::min(step.duration_s, time_s);
    turn = turn * quaternion_of(duration_s * (step.angular_rate_rad_per_s - bias));
    time_s -= duration_s;
    if (time_s <= 0.0) break;
  }
  return turn;
}

}  // namespace

EvenTurning::EvenTurning(const std::vector<ImuStep>& scan, double before_stamp_s,
                         const Eigen::Vector3d& gyroscope_bias_rad_per_s)
    : begin_s_(-before_stamp_s), duration_s_(0.0) {
  for (const ImuStep& step : scan) duration_s_ += step.duration_s;
  const Eigen::Vector3d& bias = gyroscope_bias_rad_per_s;
  mean_rate_rad_per_s_ = logarithm_of(turn_until(scan, bias, duration_s_)) / duration_s_;
  const Eigen::Quaterniond to_stamp = turn_until(scan, bias, before_stamp_s).conjugate();
  for (std::size_t knot = 0; knot < kKnots; ++knot) {
    const double since_s = duration_s_ * static_cast<double>(knot) / (kKnots - 1);
    const Eigen::Quaterniond turn = quaternion_of(-(begin_s_ + since_s) * mean_rate_rad_per_s_) *
                                    to_stamp * turn_until(scan, bias, since_s);
    turn_rad_.emplace_back(logarithm_of(turn).cast<float>());
  }
}

void EvenTurning::apply(Features& features) const {
  for (auto* points : {&features.sharp_edges, &features.edges, &features.flat_points,
                       &features.ground, &features.surfaces, &features.posts}) {
    apply(*points);
  }
}

void EvenTurning::apply(std::vector<FeaturePoint>& points) const {
  const auto knots_per_s = static_cast<float>((kKnots - 1) / duration_s_);
  for (FeaturePoint& point : points) {
    const float at = std::clamp((point.time_offset_s - static_cast<float>(begin_s_)) * knots_per_s,
                                0.0F, static_cast<float>(kKnots - 1));
    const auto knot = std::min(static_cast<std::size_t>(at), kKnots - 2);
    const float share = at - static_cast<float>(knot);
    const Eigen::Vector3f turn_rad = (1.0F - share) * turn_rad_[knot] + share * turn_rad_[knot + 1];
    const float angle_rad = turn_rad.norm();
    if (angle_rad < 1e-8F) continue;
    const Eigen::AngleAxisf turn(angle_rad, turn_rad / angle_rad);
    point.point_m = turn * point.point_m;
    point.slope = turn * point.slope;
  }
}

}  // namespace hqslam::slam
