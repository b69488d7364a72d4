#pragma once

#include <Eigen/Core>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "front_end/cell_index.h"

namespace hqslam::slam {

/// Adds one, up to the largest number.
inline void count_up(std::uint16_t& counter) {
  if (counter < std::numeric_limits<std::uint16_t>::max()) ++counter;
}

/// The votes of the scans about one voxel. Sums are integers, so that their order does not matter.
struct Voxel {
  std::array<std::uint32_t, 3> offset_sum{};  ///< kOffsetSteps per voxel, times the weight
  std::uint32_t weight_sum = 0;
  /// Intensities of the points that offset_sum is made of: the lower 18 bits are the sum of their
  /// weights, the upper 46 that of 1024 times the intensity times the weight.
  std::uint64_t intensity_sums = 0;
  std::uint32_t odds_sum = 0;    ///< of the votes for it, 64 per unit; saturates
  std::uint32_t last_scan = 0;   ///< the last that voted, counted from 1
  std::uint16_t scan_odds = 0;   ///< of that scan's best point
  std::uint16_t times_seen = 0;  ///< saturates, as the following
  std::uint16_t times_measured = 0;
  std::uint16_t times_seen_through = 0;
};

/// A cube of 8 x 8 x 8 voxels that stores only those in which a scan had a point.
class VoxelBlock {
 public:
  static constexpr int kShift = 3;
  static constexpr int kSide = 1 << kShift;

  explicit VoxelBlock(const Eigen::Vector3i& index) : index_(index) {}
  const Eigen::Vector3i& index() const { return index_; }

  bool has(int local) const { return ((mask_[local >> 6] >> (local & 63)) & 1U) != 0; }
  /// Number of voxels before this one.
  int rank(int local) const {
    int before = std::popcount(mask_[local >> 6] & ((std::uint64_t{1} << (local & 63)) - 1));
    for (int word = 0; word < local >> 6; ++word) before += std::popcount(mask_[word]);
    return before;
  }
  std::size_t size() const { return voxels_.size(); }
  Voxel& at(int local) { return voxels_[rank(local)]; }
  const Voxel& at(int local) const { return voxels_[rank(local)]; }
  /// Adds an empty voxel where there is none.
  Voxel& add(int local) {
    mask_[local >> 6] |= std::uint64_t{1} << (local & 63);
    return *voxels_.insert(voxels_.begin() + rank(local), Voxel());
  }
  /// Calls visit(index, voxel) for each, in the order of their positions in the block.
  template <typename Visit>
  void for_each(const Visit& visit) const {
    std::size_t next = 0;
    for (int local = 0; next < voxels_.size(); ++local) {
      if (!has(local)) continue;
      const Eigen::Vector3i place(local & (kSide - 1), local >> kShift & (kSide - 1),
                                  local >> 2 * kShift);
      visit(Eigen::Vector3i(kSide * index_ + place), voxels_[next++]);
    }
  }

 private:
  Eigen::Vector3i index_;
  std::array<std::uint64_t, 8> mask_{};
  std::vector<Voxel> voxels_;  ///< in the order of their positions in the block
};

/// Voxels of a side of `voxel_m`, found by a hash of their block. Voxel (i, j, k) extends from
/// (i, j, k) voxel_m to (i + 1, j + 1, k + 1) voxel_m.
class VoxelGrid {
 public:
  explicit VoxelGrid(double voxel_m);

  double voxel_m() const { return voxel_m_; }
  std::size_t size() const { return size_; }
  const std::vector<VoxelBlock>& blocks() const { return blocks_; }

  /// The voxel of a point; nothing if the point is not finite or more than some millions of voxels
  /// from the origin.
  std::optional<Eigen::Vector3i> voxel_of(const Eigen::Vector3d& point_m) const;

  VoxelBlock& block(std::size_t number) { return blocks_[number]; }
  const VoxelBlock* find_block(const Eigen::Vector3i& block) const;
  /// nullptr where no scan had a point.
  const Voxel* find(const Eigen::Vector3i& voxel) const;
  Voxel* find(const Eigen::Vector3i& voxel);
  /// voxel: of voxel_of. Invalidates what find and find_or_add returned before.
  Voxel& find_or_add(const Eigen::Vector3i& voxel);

  static Eigen::Vector3i block_of(const Eigen::Vector3i& voxel) {
    return {voxel.x() >> VoxelBlock::kShift, voxel.y() >> VoxelBlock::kShift,
            voxel.z() >> VoxelBlock::kShift};
  }
  /// The number of a voxel in its block: x changes fastest.
  static int local_of(const Eigen::Vector3i& voxel) {
    constexpr int kMask = VoxelBlock::kSide - 1;
    return (voxel.x() & kMask) | (voxel.y() & kMask) << VoxelBlock::kShift |
           (voxel.z() & kMask) << 2 * VoxelBlock::kShift;
  }

 private:
  double voxel_m_;
  std::size_t size_ = 0;
  std::vector<VoxelBlock> blocks_;
  CellIndex index_;  ///< of blocks_
};

}  // namespace hqslam::slam
