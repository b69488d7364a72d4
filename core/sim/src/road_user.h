#pragma once

#include <cstdint>

#include "mesh.h"

namespace hqslam::sim {

/// A car standing on the origin, x forward. Of `kCarBodies` shapes: hatchback, saloon, off-roader,
/// van.
constexpr int kCarBodies = 4;
TriangleMesh make_car(int body);

/// A walker on the origin, x forward.
constexpr int kWalkerBodies = 2;
TriangleMesh make_walker(int body);

}  // namespace hqslam::sim
