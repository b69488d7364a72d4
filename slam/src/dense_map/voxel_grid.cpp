#include "dense_map/voxel_grid.h"

#include <cmath>

namespace hqslam::slam {

namespace {

/// Voxels on each side of the origin.
constexpr double kVoxelRange = 1 << 23;

std::uint64_t hash_of(const Eigen::Vector3i& block) {
  const auto part = [](int value) { return static_cast<std::uint64_t>(value) & 0x1FFFFFU; };
  std::uint64_t key = part(block.x()) << 42 | part(block.y()) << 21 | part(block.z());
  key ^= key >> 31;
  key *= 0x9E3779B97F4A7C15ULL;
  return key ^ (key >> 29);
}

}  // namespace

VoxelGrid::VoxelGrid(double voxel_m) : voxel_m_(voxel_m), table_(1024, 0) {}

std::optional<Eigen::Vector3i> VoxelGrid::voxel_of(const Eigen::Vector3d& point_m) const {
  const Eigen::Vector3d voxel = (point_m / voxel_m_).array().floor();
  // Written so that what is not a number fails.
  if (!(voxel.cwiseAbs().array() < kVoxelRange).all()) return std::nullopt;
  return voxel.cast<int>();
}

/// Where the block stands in the table, or the empty slot where it would.
std::size_t VoxelGrid::slot_of(const Eigen::Vector3i& block) const {
  const std::size_t mask = table_.size() - 1;
  std::size_t slot = hash_of(block) & mask;
  while (table_[slot] != 0 && blocks_[table_[slot] - 1].index() != block) slot = (slot + 1) & mask;
  return slot;
}

void VoxelGrid::grow_table() {
  table_.assign(2 * table_.size(), 0);
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    table_[slot_of(blocks_[i].index())] = static_cast<std::uint32_t>(i + 1);
  }
}

const VoxelBlock* VoxelGrid::find_block(const Eigen::Vector3i& block) const {
  const std::uint32_t entry = table_[slot_of(block)];
  return entry == 0 ? nullptr : &blocks_[entry - 1];
}

Voxel* VoxelGrid::find(const Eigen::Vector3i& voxel) {
  const std::uint32_t entry = table_[slot_of(block_of(voxel))];
  if (entry == 0) return nullptr;
  VoxelBlock& block = blocks_[entry - 1];
  const int local = local_of(voxel);
  return block.has(local) ? &block.at(local) : nullptr;
}

Voxel& VoxelGrid::find_or_add(const Eigen::Vector3i& voxel) {
  const Eigen::Vector3i index = block_of(voxel);
  std::size_t slot = slot_of(index);
  if (table_[slot] == 0) {
    if (2 * (blocks_.size() + 1) > table_.size()) {
      grow_table();
      slot = slot_of(index);
    }
    blocks_.emplace_back(index);
    table_[slot] = static_cast<std::uint32_t>(blocks_.size());
  }
  VoxelBlock& block = blocks_[table_[slot] - 1];
  const int local = local_of(voxel);
  if (block.has(local)) return block.at(local);
  ++size_;
  return block.add(local);
}

}  // namespace hqslam::slam
