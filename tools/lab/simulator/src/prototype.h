#pragma once

#include <cstdint>
#include <vector>

#include "mesh.h"

namespace hqslam::sim {

/// Shapes that are placed many times, each at the origin, x forward: the index of the first shape
/// of each kind among the prototypes.
constexpr int kTreeShapes = 10;
constexpr int kBushShapes = 3;
constexpr int kCarBodies = 4;  ///< hatchback, saloon, off-roader, van
constexpr int kWalkerBodies = 2;
constexpr int kFirstTree = 0;
constexpr int kFirstBush = kFirstTree + kTreeShapes;
constexpr int kFirstCar = kFirstBush + kBushShapes;
constexpr int kFirstWalker = kFirstCar + kCarBodies;
std::vector<TriangleMesh> make_prototypes(std::uint64_t seed);

}  // namespace hqslam::sim
