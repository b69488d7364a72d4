#pragma once

#include <Eigen/Core>
#include <array>

#include "dense_map/voxel_grid.h"

namespace hqslam::slam {

/// A block and the 26 that touch it, so that the neighbours of its voxels are found without asking
/// the grid for each.
class BlockSurroundings {
 public:
  BlockSurroundings(const VoxelGrid& grid, const VoxelBlock& block);

  /// nullptr where no scan had a point; voxel: in the block, or touching it.
  const Voxel* find(const Eigen::Vector3i& voxel) const;
  /// Calls visit(neighbour) for each of the at most 26 that touch a voxel of the block.
  template <typename Visit>
  void for_each_neighbour(const Eigen::Vector3i& voxel, const Visit& visit) const {
    for (int dz = -1; dz <= 1; ++dz) {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          if (dx == 0 && dy == 0 && dz == 0) continue;
          const Voxel* const neighbour = find(voxel + Eigen::Vector3i(dx, dy, dz));
          if (neighbour != nullptr) visit(*neighbour);
        }
      }
    }
  }

 private:
  static int place_of(const Eigen::Vector3i& offset) {
    return (offset.x() + 1) + 3 * (offset.y() + 1) + 9 * (offset.z() + 1);
  }
  Eigen::Vector3i index_;
  std::array<const VoxelBlock*, 27> blocks_{};
};

}  // namespace hqslam::slam
