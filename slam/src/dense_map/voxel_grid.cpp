#include "dense_map/voxel_grid.h"

#include <utility>

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

const Voxel* VoxelGrid::find(const Eigen::Vector3i& voxel) const {
  const VoxelBlock* const block = find_block(block_of(voxel));
  const int local = local_of(voxel);
  return block != nullptr && block->has(local) ? &block->at(local) : nullptr;
}

Voxel* VoxelGrid::find(const Eigen::Vector3i& voxel) {
  return const_cast<Voxel*>(std::as_const(*this).find(voxel));
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

}  // namespace hqslam::slam
