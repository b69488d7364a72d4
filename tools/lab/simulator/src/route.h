#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "layout.h"

namespace hqslam::sim {

/// A crossing of street `index[0]` of axis 0 with street `index[1]` of axis 1.
using Crossing = Eigen::Vector2i;

/// Crossings one after the other, neighbours joined by a street that is open, never turning back on
/// the spot. Made of circuits (around a rectangle of blocks and on over its first stretch again)
/// joined by short ways that like to meet driven streets from the other end; or of a loop driven in
/// both directions, whose streets must all be open. A longer route begins with the shorter one.
std::vector<Crossing> make_route(const Layout& layout, const DriverStyle& style, std::uint64_t seed,
                                 double min_length_m);

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
