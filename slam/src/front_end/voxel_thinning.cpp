#include "front_end/voxel_thinning.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

namespace hqslam::slam {

namespace {

constexpr float kReach_voxels = 1e6F;

/// Voxels of a box are numbered with 32 bits.
constexpr double kMaxVoxels = 1 << 30;

struct PlacedPoint {
  Eigen::Array3i voxel;
  std::uint32_t point;
};

std::vector<PlacedPoint> placed(const std::vector<FeaturePoint>& points, float leaf_m) {
  const float per_m = 1.0F / leaf_m;
  std::vector<PlacedPoint> result;
  result.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Array3f scaled = points[i].point_m.array() * per_m;
    if (!(scaled.abs() < kReach_voxels - 1.0F).all()) continue;
    const Eigen::Array3i truncated = scaled.cast<int>();
    const Eigen::Array3i below = (scaled < truncated.cast<float>()).cast<int>();
    result.push_back({truncated - below, static_cast<std::uint32_t>(i)});
  }
  return result;
}

/// The mean of position, time and known intensities; the mean slope is normalized.
struct Mean {
  Eigen::Vector3f sum_m = Eigen::Vector3f::Zero();
  Eigen::Vector3f slope = Eigen::Vector3f::Zero();
  float time_s = 0.0F;
  float intensity_sum = 0.0F;
  int count = 0;
  int bright = 0;  ///< points of known intensity

  void add(const FeaturePoint& point) {
    sum_m += point.point_m;
    slope += point.slope;
    time_s += point.time_offset_s;
    ++count;
    if (std::isnan(point.intensity)) return;
    intensity_sum += point.intensity;
    ++bright;
  }
  FeaturePoint in_row(int row) const {
    const auto points = static_cast<float>(count);
    FeaturePoint mean{sum_m / points, time_s / points, row, slope.normalized()};
    if (bright > 0) mean.intensity = intensity_sum / static_cast<float>(bright);
    return mean;
  }
};

/// Thins the points of a box of `side` voxels that begins with the voxel `first`. Successive points
/// of one voxel, as most are, are sorted as one.
void thin_box(const std::vector<FeaturePoint>& points, std::span<const PlacedPoint> box,
              const Eigen::Array3i& first, const Eigen::Array3i& side,
              std::vector<FeaturePoint>& thinned) {
  std::vector<std::uint32_t> voxel(box.size());
  std::vector<std::uint64_t> runs;  // the voxel above where in the box the run begins
  for (std::size_t i = 0; i < box.size(); ++i) {
    const Eigen::Array3i at = box[i].voxel - first;
    voxel[i] = static_cast<std::uint32_t>(at.x() + side.x() * (at.y() + side.y() * at.z()));
    if (i == 0 || voxel[i] != voxel[i - 1]) runs.push_back(std::uint64_t{voxel[i]} << 32 | i);
  }
  std::ranges::sort(runs);
  const int row = points[box.front().point].row;
  for (auto run = runs.begin(); run != runs.end();) {
    const std::uint64_t here = *run >> 32;
    Mean mean;
    for (; run != runs.end() && *run >> 32 == here; ++run) {
      for (auto i = static_cast<std::uint32_t>(*run); i < box.size() && voxel[i] == here; ++i) {
        mean.add(points[box[i].point]);
      }
    }
    thinned.push_back(mean.in_row(row));
  }
}

/// Halves the box between two voxels until the pieces are small enough.
void thin_in_pieces(const std::vector<FeaturePoint>& points, std::span<PlacedPoint> box,
                    std::vector<FeaturePoint>& thinned) {
  if (box.empty()) return;
  Eigen::Array3i first = box.front().voxel;
  Eigen::Array3i last = first;
  for (const PlacedPoint& placed : box) {
    first = first.min(placed.voxel);
    last = last.max(placed.voxel);
  }
  const Eigen::Array3i side = last - first + 1;
  if (side.cast<double>().prod() <= kMaxVoxels) return thin_box(points, box, first, side, thinned);
  Eigen::Index longest = 0;
  const int half = side.maxCoeff(&longest) / 2;
  const auto upper = std::stable_partition(box.begin(), box.end(), [&](const auto& placed) {
    return placed.voxel[longest] < first[longest] + half;
  });
  thin_in_pieces(points, {box.begin(), upper}, thinned);
  thin_in_pieces(points, {upper, box.end()}, thinned);
}

}  // namespace

std::vector<FeaturePoint> thin(const std::vector<FeaturePoint>& points, double leaf_m) {
  std::vector<FeaturePoint> thinned;
  std::vector<PlacedPoint> all = placed(points, static_cast<float>(leaf_m));
  thin_in_pieces(points, all, thinned);
  return thinned;
}

}  // namespace hqslam::slam
