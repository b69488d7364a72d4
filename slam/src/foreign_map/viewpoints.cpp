#include "foreign_map/viewpoints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "map/cell_index.h"

namespace hqslam::slam {

namespace {

constexpr double kHeight_m = 1.7;
constexpr int kSpacing_cells = 4;  // of a metre
constexpr float kLevel = 0.94F;    // cosine of 20 degrees
constexpr float kClearFrom_m = 0.4F;
constexpr float kClearTo_m = 2.2F;
constexpr float kMaxStep_m = 0.3F;
constexpr std::size_t kMinCells = 50;

/// A square metre, seen from above.
struct ViewCell {
  Eigen::Vector3i at;
  float ground_m = std::numeric_limits<float>::infinity();
  bool is_free = true;
  bool is_taken = false;  ///< looked at
};

Eigen::Vector3i view_cell_of(const Eigen::Vector3f& point_m) {
  return {static_cast<int>(std::floor(point_m.x())), static_cast<int>(std::floor(point_m.y())), 0};
}

class Ground {
 public:
  explicit Ground(const std::vector<Surfel>& surfels) {
    for (const Surfel& surfel : surfels) {
      if (std::abs(surfel.normal.z()) < kLevel) continue;
      ViewCell& cell = find_or_add(view_cell_of(surfel.point_m));
      cell.ground_m = std::min(cell.ground_m, surfel.point_m.z());
    }
    for (const Surfel& surfel : surfels) {
      ViewCell* cell = find(view_cell_of(surfel.point_m));
      if (cell == nullptr) continue;
      const float above_m = surfel.point_m.z() - cell->ground_m;
      if (above_m > kClearFrom_m && above_m < kClearTo_m) cell->is_free = false;
    }
  }

  /// Where one can drive on and on.
  std::vector<const ViewCell*> wide_areas() {
    std::vector<const ViewCell*> result;
    for (ViewCell& cell : cells_) {
      if (!cell.is_free || cell.is_taken) continue;
      const std::vector<ViewCell*> area = area_of(cell);
      if (area.size() >= kMinCells) result.insert(result.end(), area.begin(), area.end());
    }
    return result;
  }

 private:
  ViewCell* find(const Eigen::Vector3i& at) {
    const std::uint32_t found = index_.find(at);
    return found == CellIndex::kNone ? nullptr : &cells_[found];
  }
  ViewCell& find_or_add(const Eigen::Vector3i& at) {
    if (ViewCell* cell = find(at)) return *cell;
    index_.add(CellIndex::key_of(at), static_cast<std::uint32_t>(cells_.size()));
    return cells_.emplace_back(ViewCell{at});
  }
  std::vector<ViewCell*> area_of(ViewCell& start) {
    constexpr std::array<std::array<int, 2>, 4> kSides = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
    std::vector<ViewCell*> area = {&start};
    start.is_taken = true;
    for (std::size_t i = 0; i < area.size(); ++i) {
      for (const auto& side : kSides) {
        ViewCell* next = find(area[i]->at + Eigen::Vector3i(side[0], side[1], 0));
        if (next == nullptr || !next->is_free || next->is_taken) continue;
        if (std::abs(next->ground_m - area[i]->ground_m) > kMaxStep_m) continue;
        next->is_taken = true;
        area.push_back(next);
      }
    }
    return area;
  }

  std::vector<ViewCell> cells_;
  CellIndex index_;
};

}  // namespace

std::vector<Pose> viewpoints_in(const std::vector<Surfel>& surfels) {
  Ground ground(surfels);
  std::vector<Pose> result;
  for (const ViewCell* cell : ground.wide_areas()) {
    const bool is_wanted = cell->at.x() % kSpacing_cells == 0 && cell->at.y() % kSpacing_cells == 0;
    if (!is_wanted) continue;
    result.push_back(pose_from_xyz_rpy(
        {cell->at.x() + 0.5, cell->at.y() + 0.5, cell->ground_m + kHeight_m}, 0.0, 0.0, 0.0));
  }
  return result;
}

}  // namespace hqslam::slam
