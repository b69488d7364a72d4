#include "foreign_map/surfels.h"

#include <cmath>

#include "map/cell_index.h"
#include "map/feature_map.h"
#include "map/map_matching.h"

namespace hqslam::slam {

namespace {

constexpr double kNeighbour_leaves = 5.0;
constexpr double kMaxSurfelResidual_m = 0.1;
/// Of the distance to the farthest neighbour: discs on a square grid then leave no gap.
constexpr float kRadiusShare = 0.75F;

Surfel surfel_at(const Eigen::Vector3f& point_m, const Neighbours& neighbours) {
  const auto plane = fit_plane(neighbours, kMaxSurfelResidual_m);
  return {point_m, plane ? Eigen::Vector3f(plane->normal.cast<float>()) : Eigen::Vector3f::Zero(),
          kRadiusShare * std::sqrt(neighbours.squared_distance_m2.back())};
}

}  // namespace

std::vector<Surfel> surfels_of(const std::vector<Eigen::Vector3f>& points_m, double leaf_m) {
  FeatureMap thinned(leaf_m, kNeighbour_leaves * leaf_m);
  thinned.insert(points_m);
  const std::vector<Eigen::Vector3f> all_m = thinned.points_m();
  std::vector<Surfel> surfels(all_m.size());
  std::vector<std::uint8_t> is_noise(all_m.size());
#pragma omp parallel for schedule(dynamic, 1024)
  for (std::size_t i = 0; i < all_m.size(); ++i) {
    const Neighbours neighbours = thinned.nearest(all_m[i]);
    is_noise[i] = neighbours.count < Neighbours::kWanted ? 1 : 0;
    if (is_noise[i] == 0) surfels[i] = surfel_at(all_m[i], neighbours);
  }
  std::vector<Surfel> result;
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    if (is_noise[i] == 0) result.push_back(surfels[i]);
  }
  return result;
}

SurfelTiles::SurfelTiles(const std::vector<Surfel>& surfels) {
  CellIndex index;
  for (const Surfel& surfel : surfels) {
    const Eigen::Vector2f at = (surfel.point_m.head<2>() / kTile_m).array().floor();
    const auto key = CellIndex::key_of({static_cast<int>(at.x()), static_cast<int>(at.y()), 0});
    std::uint32_t tile = index.find(key);
    if (tile == CellIndex::kNone) {
      tile = static_cast<std::uint32_t>(tiles_.size());
      index.add(key, tile);
      tiles_.push_back({(at.array() + 0.5F) * kTile_m, {}});
    }
    tiles_[tile].surfels.push_back(surfel);
  }
}

}  // namespace hqslam::slam
