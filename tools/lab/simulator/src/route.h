#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "layout.h"

namespace hqslam::sim {

/// A crossing of street `index[0]` of axis 0 with street `index[1]` of axis 1.
using Crossing = Eigen::Vector2i;

/// Successive crossings, joined by open streets, without a turn on the spot: circuits (around a
/// rectangle of blocks and over its first stretch again) joined by short stretches that preferably
/// follow driven streets in the opposite direction, or a loop driven in both directions, whose
/// streets must all be open. A longer route begins with the shorter one.
std::vector<Crossing> make_route(const Layout& layout, const DriverStyle& style, std::uint64_t seed,
                                 double min_length_m);

/// A point of the car's path, in the plane.
struct LanePoint {
  Eigen::Vector2d plane_m;
  double speed_limit_mps = 0.0;
  double stop_s = 0.0;  ///< duration of a stop here; 0: none
};

/// The right-hand lanes along the route, corners rounded, a point every half metre or closer.
std::vector<LanePoint> lane_along(const Layout& layout, const std::vector<Crossing>& route,
                                  const DriverStyle& style, std::uint64_t seed);

}  // namespace hqslam::sim
