#include "front_end/voxel_thinning.h"

#include <cmath>
#include <cstdint>
#include <optional>

#include "front_end/cell_index.h"

namespace hqslam::slam {

namespace {

constexpr float kReach_voxels = 1e6F;

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

/// Nothing for a point that is too far away.
std::optional<std::uint64_t> voxel_of(const Eigen::Vector3f& point_m, float per_m) {
  const Eigen::Array3f scaled = point_m.array() * per_m;
  if (!(scaled.abs() < kReach_voxels - 1.0F).all()) return std::nullopt;
  const Eigen::Array3i truncated = scaled.cast<int>();
  const Eigen::Array3i below = (scaled < truncated.cast<float>()).cast<int>();
  return CellIndex::key_of(truncated - below);
}

}  // namespace

std::vector<FeaturePoint> thin(const std::vector<FeaturePoint>& points, double leaf_m) {
  const float per_m = 1.0F / static_cast<float>(leaf_m);
  CellIndex index;
  std::vector<Mean> means;
  std::optional<std::uint64_t> last;  // of successive points most are in one voxel
  std::uint32_t at = 0;
  for (const FeaturePoint& point : points) {
    const std::optional<std::uint64_t> voxel = voxel_of(point.point_m, per_m);
    if (!voxel) continue;
    if (voxel != last) at = index.find_or_add(*voxel);
    if (at == means.size()) means.emplace_back();
    means[at].add(point);
    last = voxel;
  }
  std::vector<FeaturePoint> thinned;
  thinned.reserve(means.size());
  for (const Mean& mean : means) thinned.push_back(mean.in_row(points.front().row));
  return thinned;
}

}  // namespace hqslam::slam
