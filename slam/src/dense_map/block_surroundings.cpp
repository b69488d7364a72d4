#include "dense_map/block_surroundings.h"

namespace hqslam::slam {

BlockSurroundings::BlockSurroundings(const VoxelGrid& grid, const VoxelBlock& block)
    : index_(block.index()) {
  for (int dz = -1; dz <= 1; ++dz) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const Eigen::Vector3i offset(dx, dy, dz);
        blocks_[static_cast<std::size_t>(place_of(offset))] = grid.find_block(index_ + offset);
      }
    }
  }
}

const Voxel* BlockSurroundings::find(const Eigen::Vector3i& voxel) const {
  const int place = place_of(VoxelGrid::block_of(voxel) - index_);
  const VoxelBlock* const block = blocks_[static_cast<std::size_t>(place)];
  const int local = VoxelGrid::local_of(voxel);
  return block != nullptr && block->has(local) ? &block->at(local) : nullptr;
}

}  // namespace hqslam::slam
