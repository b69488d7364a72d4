#pragma once

#include <Eigen/Geometry>

#include "layout.h"
#include "mesh.h"
#include "random.h"

namespace hqslam::sim {

/// A house on the sheet. Side 0 of the lot is that of small v, then counter-clockwise.
struct HouseLot {
  Eigen::AlignedBox2d sheet_m;
  int front = 0;                       ///< side with the door
  std::array<bool, 4> open_to_view{};  ///< sides that get windows; the others are blank
  bool detached = false;               ///< low, with a gabled roof
};

void add_house(TriangleMesh& mesh, const Layout& layout, const HouseLot& lot, Random& random);

}  // namespace hqslam::sim
