#include "live/live_map.h"

#include <cmath>
#include <utility>

namespace hqslam::tools {
namespace {

constexpr float kFarthest_m = 50'000.0F;

/// 21 bits of a coordinate: enough for 50 km in quarters of a metre on both sides.
std::uint64_t cell(float coordinate_m, float voxel_m) {
  const auto index = static_cast<std::int64_t>(std::floor(coordinate_m / voxel_m));
  return static_cast<std::uint64_t>(index + (1 << 20)) & 0x1FFFFF;
}

}  // namespace

bool LiveMap::take_voxel(const Eigen::Vector3f& point_m) {
  const std::uint64_t key = cell(point_m.x(), voxel_m_) << 42 | cell(point_m.y(), voxel_m_) << 21 |
                            cell(point_m.z(), voxel_m_);
  return taken_.insert(key).second;
}

void LiveMap::add(const Eigen::Vector3f& point_m) {
  if (!point_m.allFinite() || point_m.cwiseAbs().maxCoeff() > kFarthest_m) return;
  if (!take_voxel(point_m)) return;
  points_m_.push_back(point_m);
  if (points_m_.size() >= kMostPoints) coarsen();
}

/// Until half of the room is free again.
void LiveMap::coarsen() {
  while (points_m_.size() > kMostPoints / 2) {
    voxel_m_ *= 2.0F;
    taken_.clear();
    const std::vector<Eigen::Vector3f> finer_m = std::move(points_m_);
    points_m_.clear();
    for (const Eigen::Vector3f& point_m : finer_m) {
      if (take_voxel(point_m)) points_m_.push_back(point_m);
    }
  }
  ++generation_;
}

void LiveMap::clear() {
  points_m_.clear();
  taken_.clear();
  ++generation_;
}

}  // namespace hqslam::tools
