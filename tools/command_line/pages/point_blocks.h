#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hqslam::tools {

/// A cloud as a page carries it: 4 bytes a point, in blocks that can be drawn more or less densely.
///
/// Purpose: a map has more points than a page may have bytes or a computer can draw 30 times a
/// second. In a block, points come in such an order that those up to ends[l] are one per voxel of
/// 2^l steps: the far blocks are drawn from fewer of their points.
/// Method: coordinates in steps, interleaved bit by bit (Morton, 1966). Sorted by that number,
/// points of one voxel of any level stand together, and so do those of a block, the voxel of level
/// kLevels - 1. The first point of a voxel stands for it.
struct PointBlocks {
  static constexpr int kBitsPerAxis = 9;  ///< a block has 512 steps on each side
  static constexpr int kLevels = kBitsPerAxis + 1;
  static constexpr float kLeastStep_m = 0.02F;
  static constexpr unsigned kMostShare = 31;

  struct Block {
    Eigen::Vector3i corner;                     ///< in sides of a block, from the origin
    std::array<std::uint32_t, kLevels> ends{};  ///< per level, the finest first
  };

  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  double step_m = kLeastStep_m;
  double spacing_m = kLeastStep_m;  ///< from a point to the next, about
  std::vector<Block> blocks;
  /// Block after block: x, y and z in steps, 9 bits each from the lowest, then 5 bits of the share.
  /// A point is in the middle of its step.
  std::vector<std::uint32_t> points;
  std::vector<std::uint8_t> brightness;  ///< of each, 0 to 255; empty: none was given
};

/// At most `most_points` of the points, evenly thinned: no coordinate is farther than half a step
/// from its point's. share: of 1, per point (a confidence); empty: none is known, all are 1. Points
/// that are not finite are left out. brightness: of 1, per point; empty: none. The same points give
/// the same bytes.
PointBlocks point_blocks(const std::vector<Eigen::Vector3f>& points_m,
                         const std::vector<float>& share, std::size_t most_points,
                         const std::vector<float>& brightness = {});

}  // namespace hqslam::tools
