#include "walking_path.h"

#include <cmath>

#include "b_spline.h"

namespace hqslam::sim {

namespace {

constexpr double kSpacing_m = 0.25;
constexpr int kSmoothingPasses = 8;
constexpr double kStandStill_s = 0.5;
constexpr double kAcceleration_mps2 = 0.8;

std::vector<Eigen::Vector3d> resampled(const std::vector<Eigen::Vector3d>& waypoints_m) {
  std::vector<Eigen::Vector3d> points_m;
  double until_next_m = 0.0;
  for (std::size_t k = 0; k + 1 < waypoints_m.size(); ++k) {
    const Eigen::Vector3d step_m = waypoints_m[k + 1] - waypoints_m[k];
    const double length_m = step_m.norm();
    while (until_next_m < length_m) {
      points_m.push_back(waypoints_m[k] + step_m * (until_next_m / length_m));
      until_next_m += kSpacing_m;
    }
    until_next_m -= length_m;
  }
  return points_m;
}

}  // namespace

WalkingPath::WalkingPath(const std::vector<Eigen::Vector3d>& waypoints_m, double pace_mps)
    : pace_mps_(pace_mps), control_m_(resampled(waypoints_m)) {
  smooth(control_m_, kSmoothingPasses);
}

WalkingPath::State WalkingPath::at_time(double time_s) const {
  const double since_s = std::max(0.0, time_s - kStandStill_s);
  const double ramp_s = pace_mps_ / kAcceleration_mps2;
  const double along_m = since_s < ramp_s ? 0.5 * kAcceleration_mps2 * since_s * since_s
                                          : pace_mps_ * (since_s - 0.5 * ramp_s);
  const auto value = spline_at(control_m_, along_m / kSpacing_m);
  return {value.position, std::atan2(value.derivative.y(), value.derivative.x())};
}

}  // namespace hqslam::sim
