#include "front_end/voxel_thinning.h"

#include <algorithm>
#include <boost/sort/spreadsort/integer_sort.hpp>
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

struct NumberedPoint {
  std::uint32_t voxel;
  std::uint32_t point;
  bool operator<(const NumberedPoint& other) const { return voxel < other.voxel; }
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

/// The mean of position and time; slopes are averaged, and made of length 1 again.
FeaturePoint mean(const std::vector<FeaturePoint>& points, std::span<const NumberedPoint> of,
                  int row) {
  Eigen::Vector3f sum_m = Eigen::Vector3f::Zero();
  Eigen::Vector4f slope = Eigen::Vector4f::Zero();
  float time_s = 0.0F;
  for (const NumberedPoint& numbered : of) {
    const FeaturePoint& point = points[numbered.point];
    sum_m += point.point_m;
    slope.head<3>() += point.slope;
    time_s += point.time_offset_s;
  }
  const auto count = static_cast<float>(of.size());
  return {sum_m / count, time_s / count, row, slope.normalized().head<3>()};
}

/// Of points whose box has so many voxels on each side, beginning with `first`.
void thin_box(const std::vector<FeaturePoint>& points, std::span<const PlacedPoint> box,
              const Eigen::Array3i& first, const Eigen::Array3i& side,
              std::vector<FeaturePoint>& thinned) {
  std::vector<NumberedPoint> numbered;
  numbered.reserve(box.size());
  for (const PlacedPoint& placed : box) {
    const Eigen::Array3i at = placed.voxel - first;
    const int voxel = at.x() + side.x() * (at.y() + side.y() * at.z());
    numbered.push_back({static_cast<std::uint32_t>(voxel), placed.point});
  }
  boost::sort::spreadsort::integer_sort(
      numbered.begin(), numbered.end(),
      [](const NumberedPoint& point, unsigned shift) { return point.voxel >> shift; });
  const int row = points[box.front().point].row;
  for (auto begin = numbered.begin(); begin != numbered.end();) {
    const auto end = std::find_if(begin, numbered.end(), [&](const NumberedPoint& point) {
      return point.voxel != begin->voxel;
    });
    thinned.push_back(mean(points, {begin, end}, row));
    begin = end;
  }
}

/// Halves the box between two voxels until its parts are small enough.
void thin_in_parts(const std::vector<FeaturePoint>& points, std::span<PlacedPoint> box,
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
  thin_in_parts(points, {box.begin(), upper}, thinned);
  thin_in_parts(points, {upper, box.end()}, thinned);
}

}  // namespace

std::vector<FeaturePoint> thin(const std::vector<FeaturePoint>& points, double leaf_m) {
  std::vector<FeaturePoint> thinned;
  std::vector<PlacedPoint> all = placed(points, static_cast<float>(leaf_m));
  thin_in_parts(points, all, thinned);
  return thinned;
}

}  // namespace hqslam::slam
