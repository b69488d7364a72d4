#include "walking_path.h"

#include <cmath>

#include "b_spline.h"
#include "mesh.h"

namespace hqslam::sim {

namespace {

constexpr double kSpacing_m = 0.25;
constexpr int kSmoothingPasses = 8;
constexpr double kStandStill_s = 0.5;
constexpr double kAcceleration_mps2 = 0.8;

}  // namespace

WalkingPath::WalkingPath(const std::vector<Eigen::Vector3d>& waypoints_m, double pace_mps)
    : pace_mps_(pace_mps), control_m_(resampled(waypoints_m, kSpacing_m).points) {
  smooth(control_m_, kSmoothingPasses);
}

Eigen::Isometry3d WalkingPath::T_world_walker(double time_s) const {
  const double since_s = std::max(0.0, time_s - kStandStill_s);
  const double ramp_s = pace_mps_ / kAcceleration_mps2;
  const double along_m = since_s < ramp_s ? 0.5 * kAcceleration_mps2 * since_s * since_s
                                          : pace_mps_ * (since_s - 0.5 * ramp_s);
  const auto value = spline_at(control_m_, along_m / kSpacing_m);
  return upright_frame(value.position, std::atan2(value.derivative.y(), value.derivative.x()));
}

}  // namespace hqslam::sim
