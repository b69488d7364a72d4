#include "driver_path.h"

#include <algorithm>
#include <cmath>

#include "b_spline.h"
#include "random.h"

namespace hqslam::sim {

namespace {

constexpr double kSpacing_m = 1.0;
constexpr int kSmoothingPasses = 6;

/// Traffic needs the path for the time in which a car crosses the city.
constexpr double kForesight_s = 200.0;

/// The lane as a point every metre, with the limits and stops at these points.
struct ResampledLane {
  std::vector<Eigen::Vector2d> control_m;
  std::vector<double> limit_mps;
  std::vector<double> stop_s;
};

ResampledLane resampled_lane(const std::vector<LanePoint>& lane) {
  std::vector<Eigen::Vector2d> corners_m;
  for (const LanePoint& point : lane) corners_m.push_back(point.plane_m);
  auto [points_m, legs] = resampled(corners_m, kSpacing_m);
  ResampledLane result{std::move(points_m), {}, {}};
  std::size_t next = 0;
  for (const std::size_t leg : legs) {
    double stop_s = 0.0;
    for (; next <= leg; ++next) stop_s = std::max(stop_s, lane[next].stop_s);
    result.limit_mps.push_back(lane[leg].speed_limit_mps);
    result.stop_s.push_back(stop_s);
  }
  return result;
}

double curvature_per_m(const std::vector<Eigen::Vector2d>& control_m, std::size_t k) {
  const Eigen::Vector2d first = 0.5 * (control_m[k + 1] - control_m[k - 1]) / kSpacing_m;
  const Eigen::Vector2d second =
      (control_m[k + 1] - 2.0 * control_m[k] + control_m[k - 1]) / (kSpacing_m * kSpacing_m);
  const double speed = first.norm();
  return std::abs(first.x() * second.y() - first.y() * second.x()) / (speed * speed * speed);
}

std::vector<double> plan_speed(const ResampledLane& lane, const DriverStyle& style) {
  const std::size_t count = lane.control_m.size();
  std::vector<double> speed_mps = lane.limit_mps;
  for (std::size_t k = 1; k + 1 < count; ++k) {
    const double curvature = std::max(curvature_per_m(lane.control_m, k), 1e-6);
    speed_mps[k] = std::min(speed_mps[k], std::sqrt(style.lateral_acceleration_mps2 / curvature));
    if (lane.stop_s[k] > 0.0) speed_mps[k] = 0.0;
  }
  // The spline begins at control point 1.
  speed_mps[0] = 0.0;
  speed_mps[1] = 0.0;
  const auto reachable = [](double from_mps, double acceleration_mps2) {
    return std::sqrt(from_mps * from_mps + 2.0 * acceleration_mps2 * kSpacing_m);
  };
  for (std::size_t k = 1; k < count; ++k) {
    speed_mps[k] = std::min(speed_mps[k], reachable(speed_mps[k - 1], style.acceleration_mps2));
  }
  for (std::size_t k = count - 1; k > 0; --k) {
    speed_mps[k - 1] = std::min(speed_mps[k - 1], reachable(speed_mps[k], style.braking_mps2));
  }
  return speed_mps;
}

}  // namespace

DriverPath::DriverPath(const std::vector<LanePoint>& lane, const DriverStyle& style) {
  constexpr double kStartStop_s = 0.5;
  ResampledLane points = resampled_lane(lane);
  smooth(points.control_m, kSmoothingPasses);
  const std::vector<double> speed_mps = plan_speed(points, style);
  control_m_ = std::move(points.control_m);
  double time_s = kStartStop_s;
  knots_.push_back({0.0, 0.0, 0.0});
  knots_.push_back({time_s, 0.0, 0.0});
  for (std::size_t k = 2; k + 2 < control_m_.size(); ++k) {
    time_s += 2.0 * kSpacing_m / std::max(speed_mps[k - 1] + speed_mps[k], 1e-3);
    knots_.push_back({time_s, static_cast<double>(k - 1) * kSpacing_m, speed_mps[k]});
    if (points.stop_s[k] > 0.0) {
      time_s += points.stop_s[k];
      knots_.push_back({time_s, static_cast<double>(k - 1) * kSpacing_m, 0.0});
    }
  }
}

PathState DriverPath::at_time(double time_s) const {
  const double clamped_s = std::clamp(time_s, 0.0, duration_s());
  const auto after =
      std::upper_bound(knots_.begin() + 1, knots_.end() - 1, clamped_s,
                       [](double wanted_s, const Knot& knot) { return wanted_s < knot.time_s; });
  const Knot& from = *(after - 1);
  const double span_s = after->time_s - from.time_s;
  const double since_s = clamped_s - from.time_s;
  const double acceleration = (after->speed_mps - from.speed_mps) / span_s;
  PathState state =
      at_distance(from.along_m + from.speed_mps * since_s + 0.5 * acceleration * since_s * since_s);
  state.speed_mps *= from.speed_mps + acceleration * since_s;
  return state;
}

PathState DriverPath::at_distance(double along_m) const {
  const auto value = spline_at(control_m_, along_m / kSpacing_m);
  return {value.position, std::atan2(value.derivative.y(), value.derivative.x()),
          value.derivative.norm() / kSpacing_m, along_m};
}

DriverPath plan_path(const Layout& layout, const DriverStyle& style, std::uint64_t drive_seed,
                     double duration_s) {
  const std::uint64_t seed = seed_of(drive_seed, DrivePart::kPath);
  const double length_m = (duration_s + kForesight_s) * style.max_limit_mps;
  const auto route = make_route(layout, style, seed_of(seed, 1), length_m);
  return {lane_along(layout, route, style, seed_of(seed, 2)), style};
}

}  // namespace hqslam::sim
