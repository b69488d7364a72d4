#pragma once

#include "layout.h"
#include "mesh.h"

namespace hqslam::sim {

/// The surfaces that one drives and walks on: streets, kerbs, sidewalks and the inside of blocks,
/// and the open land around the city.
void add_streets(TriangleMesh& mesh, const Layout& layout);
void add_block_ground(TriangleMesh& mesh, const Layout& layout, const Block& block);
void add_open_land(TriangleMesh& mesh, const Layout& layout);

}  // namespace hqslam::sim
