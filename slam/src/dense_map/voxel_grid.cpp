#include "dense_map/voxel_grid.h"

namespace hqslam::slam {

namespace {

/// Voxels on each side of the origin.
constexpr double kVoxelRange = double{CellIndex::kRange} * VoxelBlock::kSide;

}  // namespace

VoxelGrid::VoxelGrid(double voxel_m) : voxel_m_(voxel_m) {}

std::optional<Eigen::Vector3i> VoxelGrid::voxel_of(const Eigen::Vector3d& point_m) const {
  const Eigen::Vector3d voxel = (point_m / voxel_m_).array().floor();
  // NaN fails.
  if (!(voxel.cwiseAbs().array() < kVoxelRange).all()) return std::nullopt;
  return voxel.cast<int>();
}

const VoxelBlock* VoxelGrid::find_block(const Eigen::Vector3i& block) const {
  const std::uint32_t found = index_.find(block);
  return found == CellIndex::kNone ? nullptr : &blocks_[found];
}

Voxel* VoxelGrid::find(const Eigen::Vector3i& voxel) {
  const std::uint32_t found = index_.find(block_of(voxel));
  const int local = local_of(voxel);
  if (found == CellIndex::kNone || !blocks_[found].has(local)) return nullptr;
  return &blocks_[found].at(local);
}

Voxel& VoxelGrid::find_or_add(const Eigen::Vector3i& voxel) {
  const std::uint32_t found = index_.find_or_add(CellIndex::key_of(block_of(voxel)));
  if (found == blocks_.size()) blocks_.emplace_back(block_of(voxel));
  VoxelBlock& block = blocks_[found];
  const int local = local_of(voxel);
  if (block.has(local)) return block.at(local);
  ++size_;
  return block.add(local);
}

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
