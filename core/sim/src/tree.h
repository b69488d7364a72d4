#pragma once

#include <cstdint>

#include "mesh.h"

namespace hqslam::sim {

/// A tree at the origin, broadleaf or conifer: trunk, branches and a crown of single leaf quads, so
/// that some rays pass between them.
TriangleMesh make_tree(std::uint64_t seed);

/// A bush at the origin, about a metre high.
TriangleMesh make_bush(std::uint64_t seed);

}  // namespace hqslam::sim
