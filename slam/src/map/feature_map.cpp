#include "map/feature_map.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "map/nearest_list.h"

namespace hqslam::slam {

namespace {

/// Points averaged per voxel; later ones do not change it, so that the drift of a later visit does
/// not smear the map.
constexpr std::uint16_t kMaxMeanCount = 20;

constexpr int kCubeRange = CellIndex::kRange;  // cubes on each side of the origin

/// In: values in the range of int. std::floor is a call on processors without SSE4.1.
Eigen::Vector3i floored(const Eigen::Vector3f& v) {
  const Eigen::Array3i truncated = v.array().cast<int>();
  return truncated - (v.array() < truncated.cast<float>()).cast<int>();
}

constexpr int kCellBits = 24;  // of the place of a point, below the corner of its cube

/// One more than are kept: no other point is nearer than that.
using Nearest = NearestList<NearbyPoints::kKept + 1>;

/// Visits the points of one of at most eight cubes.
template <typename Cells>
void look_through(const Cells& cells, std::uint32_t corner, const Eigen::Vector3f& query_m,
                  Nearest& nearest) {
  constexpr std::size_t kCellsAtOnce = 32;
  for (std::size_t begin = 0; begin < cells.size(); begin += kCellsAtOnce) {
    const std::size_t count = std::min(cells.size() - begin, kCellsAtOnce);
    std::array<float, kCellsAtOnce> candidates_m2;
    std::array<std::uint32_t, kCellsAtOnce> candidate;
    std::size_t candidates = 0;
    const float bound_m2 = nearest.bound_m2();
    for (std::size_t i = 0; i < count; ++i) {
      const float away_m2 = (cells[begin + i].mean_m - query_m).squaredNorm();
      candidates_m2[candidates] = away_m2;
      candidate[candidates] = static_cast<std::uint32_t>(begin + i);
      candidates += away_m2 < bound_m2 ? 1 : 0;
    }
    for (std::size_t i = 0; i < candidates; ++i) {
      nearest.insert(candidates_m2[i], corner << kCellBits | candidate[i]);
    }
  }
}

/// The mean intensity of a voxel after others were added to it, `all.count` points together.
float mean_intensity(const MapPoint& all, const MapPoint& others) {
  if (std::isnan(all.intensity)) return others.intensity;
  if (std::isnan(others.intensity)) return all.intensity;
  return all.intensity + static_cast<float>(others.count) * (others.intensity - all.intensity) /
                             static_cast<float>(all.count);
}

}  // namespace

bool Surroundings::contains(const Eigen::Vector3f& point_m) const {
  const Eigen::Vector3f offset_m = point_m - centre_m;
  return offset_m.head<2>().norm() <= radius_m && std::abs(offset_m.z()) <= half_height_m();
}

FeatureMap::FeatureMap(double leaf_m, double max_distance_m)
    : leaf_m_(static_cast<float>(leaf_m)),
      max_distance_m_(static_cast<float>(max_distance_m)),
      cube_m_(static_cast<float>(2.0 * max_distance_m)),
      voxels_per_side_(static_cast<int>(std::ceil(2.0 * max_distance_m / leaf_m))) {}

FeatureMap::Cube& FeatureMap::find_or_add(std::uint64_t key) {
  const std::uint32_t found = index_.find_or_add(key);
  return found < cubes_.size() ? cubes_[found] : cubes_.emplace_back(Cube{key, {}});
}

void FeatureMap::insert(const std::vector<Eigen::Vector3f>& points_m, std::uint32_t keyframe,
                        const std::vector<float>& intensity) {
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    MapPoint point{points_m[i], keyframe, keyframe};
    if (!intensity.empty()) point.intensity = intensity[i];
    insert_point(point);
  }
}

void FeatureMap::insert(const std::vector<MapPoint>& points) {
  for (const MapPoint& point : points) insert_point(point);
}

std::optional<FeatureMap::Voxel> FeatureMap::voxel_of(const Eigen::Vector3f& point_m) const {
  const Eigen::Vector3f scaled = point_m / cube_m_;
  if (!(scaled.array().abs() < static_cast<float>(kCubeRange - 1)).all()) return std::nullopt;
  const Eigen::Vector3i cube = floored(scaled);
  Voxel result;
  result.cube_key = CellIndex::key_of(cube);
  const Eigen::Vector3i at = floored((point_m - cube.cast<float>() * cube_m_) / leaf_m_)
                                 .cwiseMax(0)
                                 .cwiseMin(voxels_per_side_ - 1);
  result.in_cube =
      static_cast<std::uint16_t>((at.x() * voxels_per_side_ + at.y()) * voxels_per_side_ + at.z());
  return result;
}

void FeatureMap::insert_point(const MapPoint& inserted) {
  const std::optional<Voxel> voxel = voxel_of(inserted.mean_m);
  if (!voxel) return;
  Cube& cube = find_or_add(voxel->cube_key);
  for (Cell& cell : cube.cells) {
    if (cell.voxel != voxel->in_cube) continue;
    cell.keyframe = std::min(cell.keyframe, inserted.keyframe);
    cell.last_observed = std::max(cell.last_observed, inserted.last_observed);
    if (cell.count < kMaxMeanCount) {
      constexpr int kMostCounted = std::numeric_limits<std::uint16_t>::max();
      cell.count = static_cast<std::uint16_t>(std::min(cell.count + inserted.count, kMostCounted));
      cell.mean_m += static_cast<float>(inserted.count) * (inserted.mean_m - cell.mean_m) /
                     static_cast<float>(cell.count);
      cell.intensity = mean_intensity(cell, inserted);
    }
    return;
  }
  cube.cells.push_back({inserted, voxel->in_cube});
  ++size_;
}

template <typename Wanted>
std::vector<MapPoint> FeatureMap::take(const std::vector<std::size_t>& cubes,
                                       const Wanted& wanted) {
  std::vector<MapPoint> taken;
  for (const std::size_t cube : cubes) {
    std::vector<Cell>& cells = cubes_[cube].cells;
    const auto first_taken = std::stable_partition(cells.begin(), cells.end(),
                                                   [&, key = cubes_[cube].key](const Cell& cell) {
                                                     return !wanted(cell, Voxel{key, cell.voxel});
                                                   });
    for (auto cell = first_taken; cell != cells.end(); ++cell) taken.push_back(*cell);
    cells.erase(first_taken, cells.end());
  }
  size_ -= taken.size();
  return taken;
}

std::vector<MapPoint> FeatureMap::take_not_observed_since(std::uint32_t keyframe) {
  std::vector<MapPoint> taken = take(
      all_cubes(), [&](const MapPoint& point, Voxel) { return point.last_observed < keyframe; });
  drop_empty_cubes();
  return taken;
}

std::vector<MapPoint> FeatureMap::take_near(const Surroundings& place) {
  return take(cubes_touching(place),
              [&](const MapPoint& point, Voxel) { return place.contains(point.mean_m); });
}

/// Otherwise a map that moves with a sensor would grow without bound.
void FeatureMap::drop_empty_cubes() {
  const auto is_empty = [](const Cube& cube) { return cube.cells.empty(); };
  const auto empty = static_cast<std::size_t>(std::ranges::count_if(cubes_, is_empty));
  if (2 * empty <= cubes_.size()) return;
  std::erase_if(cubes_, is_empty);
  index_.clear();
  for (const Cube& cube : cubes_) index_.find_or_add(cube.key);
}

NearbyPoints FeatureMap::nearby(const Eigen::Vector3f& query_m, float reach_m) const {
  const Eigen::Vector3f scaled = query_m / cube_m_;
  if (!(scaled.array().abs() < static_cast<float>(kCubeRange - 1)).all()) return {};
  // The ball has the diameter of a cube: along each axis it intersects the query's own cube and the
  // one beyond the nearer face. Cubes farther than the last neighbour so far are skipped.
  const Eigen::Vector3i own = floored(scaled);
  const Eigen::Array3f inside = scaled.array() - own.cast<float>().array();  // 0..1
  const auto is_near_lower = inside < 0.5F;
  const Eigen::Array3f face_m2 = (is_near_lower.select(inside, 1.0F - inside) * cube_m_).square();
  const Eigen::Array3i beyond = own.array() + is_near_lower.select(Eigen::Array3i::Constant(-1), 1);
  Nearest nearest(reach_m * reach_m);
  std::array<const Cube*, 8> cubes{};
  std::array<float, 8> corner_m2;
  // The bits of a corner are its axes beyond a face.
  for (std::uint32_t corner = 0; corner < 8; ++corner) {
    Eigen::Vector3i cube = own;
    float away_m2 = 0.0F;
    for (int axis = 0; axis < 3; ++axis) {
      const bool is_beyond = (corner >> axis & 1U) != 0;
      cube[axis] = is_beyond ? beyond[axis] : own[axis];
      away_m2 += is_beyond ? face_m2[axis] : 0.0F;
    }
    corner_m2[corner] = away_m2;
    if (away_m2 >= nearest.bound_m2()) continue;
    const std::uint32_t found = index_.find(CellIndex::key_of(cube));
    if (found == CellIndex::kNone) continue;
    cubes[corner] = &cubes_[found];
  }
  // Nearer cubes first.
  for (const std::uint32_t corner : {0U, 1U, 2U, 4U, 3U, 5U, 6U, 7U}) {
    if (cubes[corner] == nullptr || corner_m2[corner] >= nearest.bound_m2()) continue;
    look_through(cubes[corner]->cells, corner, query_m, nearest);
  }
  NearbyPoints result{query_m, 0, {}, std::sqrt(nearest.bound_m2())};
  while (result.count < NearbyPoints::kKept &&
         nearest.squared_m2(result.count) < reach_m * reach_m) {
    const std::uint32_t place = nearest.place(result.count);
    result.points_m[result.count++] =
        cubes[place >> kCellBits]->cells[place & ((1U << kCellBits) - 1U)].mean_m;
  }
  return result;
}

Neighbours NearbyPoints::nearest(const Eigen::Vector3f& query_m) const {
  const float known_m = std::max(others_beyond_m - (query_m - place_m).norm(), 0.0F);
  NearestList<Neighbours::kWanted + 1> nearest(known_m * known_m);
  for (int i = 0; i < count; ++i) {
    nearest.insert((points_m[i] - query_m).squaredNorm(), static_cast<std::uint32_t>(i));
  }
  Neighbours result;
  while (result.count < Neighbours::kWanted &&
         nearest.squared_m2(result.count) < known_m * known_m) {
    result.squared_distance_m2[result.count] = nearest.squared_m2(result.count);
    result.points_m[result.count] = points_m[nearest.place(result.count)];
    ++result.count;
  }
  result.sixth_squared_m2 = nearest.bound_m2();
  return result;
}

/// In the order of their coordinates, which does not depend on that of their insertion.
std::vector<std::size_t> FeatureMap::cubes_touching(const Surroundings& place) const {
  const Eigen::Vector3f reach(place.radius_m, place.radius_m, place.half_height_m());
  const auto has_room = static_cast<float>(kCubeRange - 1);
  const auto cube_of = [&](const Eigen::Vector3f& point_m) -> Eigen::Array3i {
    return floored((point_m / cube_m_).cwiseMax(-has_room).cwiseMin(has_room));
  };
  const Eigen::Array3i first = cube_of(place.centre_m - reach);
  const Eigen::Array3i last = cube_of(place.centre_m + reach);
  std::vector<std::pair<std::uint64_t, std::size_t>> found;
  for (std::size_t i = 0; i < cubes_.size(); ++i) {
    const Eigen::Array3i cube = CellIndex::cell_of(cubes_[i].key);
    if ((cube >= first).all() && (cube <= last).all()) found.emplace_back(cubes_[i].key, i);
  }
  std::ranges::sort(found);
  std::vector<std::size_t> result;
  for (const auto& [key, cube] : found) result.push_back(cube);
  return result;
}

std::vector<std::size_t> FeatureMap::all_cubes() const {
  std::vector<std::size_t> result(cubes_.size());
  std::iota(result.begin(), result.end(), std::size_t{0});
  return result;
}

std::vector<Eigen::Vector3f> FeatureMap::points_near_m(const Surroundings& place) const {
  std::vector<Eigen::Vector3f> result;
  for (const std::size_t cube : cubes_touching(place)) {
    for (const Cell& cell : cubes_[cube].cells) {
      if (place.contains(cell.mean_m)) result.push_back(cell.mean_m);
    }
  }
  return result;
}

/// Most corrections are small, and most points stay in their voxels: only the others are
/// reinserted.
void FeatureMap::correct(const std::vector<Pose>& corrections) {
  std::vector<std::uint8_t> moves;
  for (const Pose& correction : corrections) moves.push_back(!correction.matrix().isIdentity(0.0));
  for (Cube& cube : cubes_) {
    for (Cell& cell : cube.cells) {
      if (moves[cell.keyframe] == 0) continue;
      cell.mean_m = (corrections[cell.keyframe] * cell.mean_m.cast<double>()).cast<float>();
    }
  }
  insert(take(all_cubes(), [&](const MapPoint& point, const Voxel& voxel) {
    return moves[point.keyframe] != 0 && voxel_of(point.mean_m) != voxel;
  }));
}

std::vector<Eigen::Vector3f> FeatureMap::points_m() const {
  std::vector<Eigen::Vector3f> result;
  result.reserve(size_);
  for (const Cube& cube : cubes_) {
    for (const Cell& cell : cube.cells) result.push_back(cell.mean_m);
  }
  return result;
}

std::vector<float> FeatureMap::intensity() const {
  std::vector<float> result;
  result.reserve(size_);
  for (const Cube& cube : cubes_) {
    for (const Cell& cell : cube.cells) result.push_back(cell.intensity);
  }
  const bool is_any_known = std::ranges::any_of(result, [](float i) { return !std::isnan(i); });
  return is_any_known ? result : std::vector<float>{};
}

}  // namespace hqslam::slam
