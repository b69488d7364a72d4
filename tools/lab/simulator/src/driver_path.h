#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "layout.h"
#include "route.h"
#include "style.h"

namespace hqslam::sim {

/// The state of the car on its path.
struct PathState {
  Eigen::Vector2d plane_m;
  double heading_rad = 0.0;
  double speed_mps = 0.0;
  double along_m = 0.0;  ///< driven since the start
};

/// The path of the sensor's car as a curve with continuous curvature, and the speed along it.
///
/// Curve: the lane resampled every metre, smoothed, and taken as control points of a uniform cubic
/// B-spline; one metre of `along_m` is one knot (true to a few per cent in tight corners, where the
/// curve is shorter). Speed v at the control points: at most the limit, sqrt(a_lateral / curvature)
/// and 0 at stops, and dv/dt within [-braking, acceleration]: a pass forwards and one backwards of
/// v_next^2 <= v^2 + 2 a ds. Between control points dv/dt is constant.
class DriverPath {
 public:
  DriverPath(const std::vector<LanePoint>& lane, const DriverStyle& style);
  double duration_s() const { return knots_.back().time_s; }
  PathState at_time(double time_s) const;
  /// The state as if it were driven through `along_m` at 1 m/s.
  PathState at_distance(double along_m) const;

 private:
  struct Knot {
    double time_s;
    double along_m;
    double speed_mps;
  };
  std::vector<Eigen::Vector2d> control_m_;
  std::vector<Knot> knots_;
};

/// The path of the sensor's car for at least `duration_s` and the time for which traffic needs it.
/// A longer path begins with the shorter one.
DriverPath plan_path(const Layout& layout, const DriverStyle& style, std::uint64_t drive_seed,
                     double duration_s);

}  // namespace hqslam::sim
