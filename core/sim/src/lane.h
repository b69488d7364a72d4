#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "layout.h"
#include "route.h"

namespace hqslam::sim {

/// A point on the way of the car, in the plane.
struct LanePoint {
  Eigen::Vector2d plane_m;
  double speed_limit_mps = 0.0;
  double stop_s = 0.0;  ///< how long the driver stops here; 0: drives on
};

/// The right-hand lanes along the route, corners rounded, a point every half metre or closer.
std::vector<LanePoint> lane_along(const Layout& layout, const std::vector<Crossing>& route,
                                  const DriverStyle& style, std::uint64_t seed);

}  // namespace hqslam::sim
