#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>

namespace hqslam::slam {

/// A section of a beam: points origin + s direction, s from begin to end, metres.
struct BeamSection {
  Eigen::Vector3d origin_m;
  Eigen::Vector3d direction;  ///< of length 1
  double begin_m = 0.0;
  double end_m = 0.0;
};

/// Calls visit(cell, begin_m, end_m) for every cell of a grid of cubes that a section of a beam
/// crosses, in order along the beam, with the section inside the cell.
/// Source: Amanatides & Woo, "A fast voxel traversal algorithm for ray tracing", 1987.
template <typename Visit>
void walk_grid(const BeamSection& beam, double cell_m, const Visit& visit) {
  const Eigen::Vector3d from = (beam.origin_m + beam.begin_m * beam.direction) / cell_m;
  Eigen::Vector3i cell = from.array().floor().template cast<int>();
  Eigen::Vector3d next_m;  // distance at which the beam leaves the cell along each axis
  Eigen::Vector3d per_cell_m;
  for (int axis = 0; axis < 3; ++axis) {
    const double along = beam.direction[axis];
    per_cell_m[axis] =
        along == 0.0 ? std::numeric_limits<double>::infinity() : cell_m / std::abs(along);
    const double border = (cell[axis] + (along > 0.0 ? 1.0 : 0.0)) * cell_m;
    next_m[axis] = along == 0.0 ? std::numeric_limits<double>::infinity()
                                : (border - beam.origin_m[axis]) / along;
  }
  for (double at_m = beam.begin_m; at_m < beam.end_m;) {
    int axis = next_m.x() < next_m.y() ? 0 : 1;
    if (next_m.z() < next_m[axis]) axis = 2;
    const double leaves_m = std::min(next_m[axis], beam.end_m);
    visit(cell, at_m, leaves_m);
    at_m = next_m[axis];
    cell[axis] += beam.direction[axis] > 0.0 ? 1 : -1;
    next_m[axis] += per_cell_m[axis];
  }
}

}  // namespace hqslam::slam
