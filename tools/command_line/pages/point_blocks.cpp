#include "pages/point_blocks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>

namespace hqslam::tools {
namespace {

constexpr int kBitsPerCode = 21;  ///< and axis: 3 x 21 bits fill 64
constexpr int kAxes = 3;
/// Where points are thinned, voxels have at least this many steps: positions are hardly rounded.
constexpr int kLevelOfThinning = 2;

/// The lowest 21 bits, two zeros after each.
std::uint64_t spread(std::uint64_t bits) {
  bits &= 0x1FFFFF;
  bits = (bits | bits << 32U) & 0x1F00000000FFFF;
  bits = (bits | bits << 16U) & 0x1F0000FF0000FF;
  bits = (bits | bits << 8U) & 0x100F00F00F00F00F;
  bits = (bits | bits << 4U) & 0x10C30C30C30C30C3;
  return (bits | bits << 2U) & 0x1249249249249249;
}

/// Every third bit.
std::uint32_t gathered(std::uint64_t bits) {
  std::uint32_t result = 0;
  for (int i = 0; i < kBitsPerCode; ++i) {
    result |= static_cast<std::uint32_t>(bits >> (kAxes * i) & 1U) << i;
  }
  return result;
}

Eigen::Vector3i steps_of(std::uint64_t code) {
  return Eigen::Vector3i(gathered(code), gathered(code >> 1U), gathered(code >> 2U));
}

struct CodedPoint {
  std::uint64_t code = 0;
  std::uint8_t share = 0;
  std::uint8_t brightness = 0;
  std::int32_t level = 0;  ///< the highest of whose voxels it is the first point
};

Eigen::AlignedBox3d box_of(const std::vector<Eigen::Vector3f>& points_m) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& point_m : points_m) {
    if (point_m.allFinite()) box.extend(point_m.cast<double>());
  }
  return box;
}

/// A value of 0 to 1 as a number of steps; NaN gives 0.
std::uint8_t steps_of_one(float value, unsigned steps) {
  return static_cast<std::uint8_t>(
      std::lround((value > 0.0F ? std::min(value, 1.0F) : 0.0F) * static_cast<float>(steps)));
}

std::vector<CodedPoint> coded(const std::vector<Eigen::Vector3f>& points_m,
                              const std::vector<float>& share, const std::vector<float>& brightness,
                              const PointBlocks& blocks) {
  std::vector<CodedPoint> result;
  result.reserve(points_m.size());
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    if (!points_m[i].allFinite()) continue;
    const Eigen::Vector3d steps = (points_m[i].cast<double>() - blocks.origin_m) / blocks.step_m;
    CodedPoint point;
    for (int axis = 0; axis < kAxes; ++axis) {
      point.code |= spread(static_cast<std::uint64_t>(steps[axis])) << axis;
    }
    point.share = steps_of_one(share.empty() ? 1.0F : share[i], PointBlocks::kMostShare);
    if (!brightness.empty()) point.brightness = steps_of_one(brightness[i], 255);
    result.push_back(point);
  }
  // The point with the highest share comes first of those in one place; the others are removed.
  std::ranges::sort(result, [](const CodedPoint& a, const CodedPoint& b) {
    return std::tuple(a.code, b.share, b.brightness) < std::tuple(b.code, a.share, a.brightness);
  });
  const auto same = [](const CodedPoint& a, const CodedPoint& b) { return a.code == b.code; };
  result.erase(std::unique(result.begin(), result.end(), same), result.end());
  for (std::size_t i = 0; i < result.size(); ++i) {
    const std::uint64_t differing = i == 0 ? ~0ULL >> 1U : result[i].code ^ result[i - 1].code;
    result[i].level = (static_cast<int>(std::bit_width(differing)) - 1) / kAxes;
  }
  return result;
}

/// Per level how many points there are of it and above.
std::array<std::size_t, kBitsPerCode> counts_of(const std::vector<CodedPoint>& points) {
  std::array<std::size_t, kBitsPerCode> counts{};
  for (const CodedPoint& point : points) ++counts[static_cast<std::size_t>(point.level)];
  for (std::size_t level = kBitsPerCode - 1; level > 0; --level) counts[level - 1] += counts[level];
  return counts;
}

/// Removes the points of the finest levels, as many as there are too many: all of a level, or an
/// even part of it. Returns the finest level of which all points are left.
int thin(std::vector<CodedPoint>& points, std::size_t most_points) {
  const auto counts = counts_of(points);
  int level = 0;
  while (level + 1 < kBitsPerCode && counts[static_cast<std::size_t>(level)] > most_points) ++level;
  if (level == 0) return 0;
  const std::size_t coarse = counts[static_cast<std::size_t>(level)];
  const std::size_t finer = counts[static_cast<std::size_t>(level) - 1] - coarse;
  const std::size_t room = most_points - std::min(most_points, coarse);
  std::size_t passed = 0;
  std::erase_if(points, [&](const CodedPoint& point) {
    if (point.level >= level) return false;
    if (point.level < level - 1) return true;
    ++passed;
    return passed * room / finer == (passed - 1) * room / finer;
  });
  return level;
}

/// The side of voxels of which there are 0.65 as many as points, between those of two levels.
double spacing_of(const std::vector<CodedPoint>& points, double step_m) {
  constexpr double kAlone = 0.65;
  const auto counts = counts_of(points);
  const auto share = [&](std::size_t level) {
    return static_cast<double>(counts[level]) / static_cast<double>(counts[0]);
  };
  std::size_t level = 1;
  while (level + 1 < kBitsPerCode && share(level) > kAlone) ++level;
  const double finer = share(level - 1);
  const double part = (finer - kAlone) / std::max(finer - share(level), 1e-9);
  return step_m * std::exp2(static_cast<double>(level - 1) + std::clamp(part, 0.0, 1.0));
}

}  // namespace

PointBlocks point_blocks(const std::vector<Eigen::Vector3f>& points_m,
                         const std::vector<float>& share, std::size_t most_points,
                         const std::vector<float>& brightness) {
  PointBlocks result;
  const Eigen::AlignedBox3d box = box_of(points_m);
  if (box.isEmpty()) return result;
  result.origin_m = box.min();
  constexpr double kMostSteps = (1 << kBitsPerCode) - 2;
  result.step_m = std::max(result.step_m, box.sizes().maxCoeff() / kMostSteps);
  std::vector<CodedPoint> points = coded(points_m, share, brightness, result);
  const int level = thin(points, most_points);
  const int coarser = std::max(0, level - kLevelOfThinning);
  result.step_m = std::ldexp(result.step_m, coarser);
  for (CodedPoint& point : points) {
    point.code >>= kAxes * coarser;
    point.level -= coarser;
  }
  result.spacing_m = spacing_of(points, result.step_m);

  constexpr int kBlockBits = kAxes * PointBlocks::kBitsPerAxis;
  for (auto begin = points.begin(); begin != points.end();) {
    const std::uint64_t of_block = begin->code >> kBlockBits;
    const auto end = std::find_if(begin, points.end(), [&](const CodedPoint& point) {
      return point.code >> kBlockBits != of_block;
    });
    std::stable_sort(begin, end,
                     [](const CodedPoint& a, const CodedPoint& b) { return a.level > b.level; });
    PointBlocks::Block& block = result.blocks.emplace_back();
    block.corner = steps_of(of_block);
    for (auto point = begin; point != end; ++point) {
      const Eigen::Vector3i steps = steps_of(point->code & ((1ULL << kBlockBits) - 1));
      result.points.push_back(static_cast<std::uint32_t>(steps.x()) |
                              static_cast<std::uint32_t>(steps.y()) << 9U |
                              static_cast<std::uint32_t>(steps.z()) << 18U |
                              static_cast<std::uint32_t>(point->share) << 27U);
      if (!brightness.empty()) result.brightness.push_back(point->brightness);
      for (int l = 0; l < PointBlocks::kLevels && l <= point->level; ++l) {
        ++block.ends[static_cast<std::size_t>(l)];
      }
    }
    begin = end;
  }
  return result;
}

}  // namespace hqslam::tools
