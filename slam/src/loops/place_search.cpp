#include "loops/place_search.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace hqslam::slam {

namespace {

constexpr double kCell_m = 0.5;
constexpr double kHalfSide_m = 60.0;
constexpr int kSide = static_cast<int>(2.0 * kHalfSide_m / kCell_m);
constexpr double kTurnStep_rad = 0.035;  // 0.5 m in 15 m
constexpr double kOtherPeak_m = 3.0;
constexpr float kMinUprightHeight_m = 0.8F;

/// The cell of a coordinate, possibly outside of the grid.
int cell_of(float coordinate_m) {
  return static_cast<int>(std::floor((coordinate_m + kHalfSide_m) / kCell_m));
}

bool inside(int x, int y) { return x >= 0 && x < kSide && y >= 0 && y < kSide; }
std::size_t index_of(int x, int y) { return static_cast<std::size_t>(x) * kSide + y; }

/// The place from above: 2 in cells with structure, 1 beside them, 0 elsewhere.
std::vector<std::uint8_t> drawn(const std::vector<Eigen::Vector3f>& structure_m) {
  std::vector<std::uint8_t> grid(static_cast<std::size_t>(kSide) * kSide, 0);
  for (const Eigen::Vector3f& point_m : structure_m) {
    const int x = cell_of(point_m.x());
    const int y = cell_of(point_m.y());
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        if (!inside(x + dx, y + dy)) continue;
        std::uint8_t& cell = grid[index_of(x + dx, y + dy)];
        cell = std::max(cell, static_cast<std::uint8_t>(dx == 0 && dy == 0 ? 2 : 1));
      }
    }
  }
  return grid;
}

/// The scores of all shifts, in cells of the grid, for one rotation.
class ShiftScores {
 public:
  ShiftScores(const std::vector<std::uint8_t>& grid, const std::vector<Eigen::Vector3f>& points_m,
              double yaw_rad, int reach)
      : reach_(reach), scores_(static_cast<std::size_t>(side()) * side(), 0) {
    const Eigen::Rotation2Df turn(static_cast<float>(yaw_rad));
    for (const Eigen::Vector3f& point_m : points_m) {
      const Eigen::Vector2f turned_m = turn * point_m.head<2>();
      add(grid, cell_of(turned_m.x()), cell_of(turned_m.y()));
    }
  }

  int at(int dx, int dy) const { return scores_[index(dx, dy)]; }

 private:
  int side() const { return 2 * reach_ + 1; }
  std::size_t index(int dx, int dy) const {
    return static_cast<std::size_t>(dx + reach_) * side() + dy + reach_;
  }
  void add(const std::vector<std::uint8_t>& grid, int x, int y) {
    if (!inside(x - reach_, y - reach_) || !inside(x + reach_, y + reach_)) return;
    for (int dx = -reach_; dx <= reach_; ++dx) {
      const std::uint8_t* row = &grid[index_of(x + dx, y - reach_)];
      int* score = &scores_[index(dx, -reach_)];
      for (int i = 0; i < side(); ++i) score[i] += row[i];
    }
  }

  int reach_;
  std::vector<int> scores_;
};

struct Peak {
  int score = 0;
  int dx = 0;
  int dy = 0;
  double yaw_rad = 0.0;
};

bool is_elsewhere(const Peak& a, const Peak& b) {
  return std::hypot(a.dx - b.dx, a.dy - b.dy) * kCell_m >= kOtherPeak_m;
}

/// The best of all shifts and rotations, away from `taken` if that is given.
Peak best_of(const std::vector<std::pair<double, ShiftScores>>& turns, int reach,
             const Peak* taken) {
  Peak best;
  for (const auto& [yaw_rad, scores] : turns) {
    for (int dx = -reach; dx <= reach; ++dx) {
      for (int dy = -reach; dy <= reach; ++dy) {
        const Peak peak{scores.at(dx, dy), dx, dy, yaw_rad};
        if (peak.score > best.score && (taken == nullptr || is_elsewhere(peak, *taken))) {
          best = peak;
        }
      }
    }
  }
  return best;
}

}  // namespace

std::vector<PlacedPoints> search_place(const std::vector<Eigen::Vector3f>& structure_m,
                                       const std::vector<Eigen::Vector3f>& points_m,
                                       const SearchWindow& window) {
  const std::vector<std::uint8_t> grid = drawn(structure_m);
  const int reach = static_cast<int>(std::lround(window.max_shift_m / kCell_m));
  const int turns_each_way = static_cast<int>(std::ceil(window.max_turn_rad / kTurnStep_rad));
  std::vector<std::pair<double, ShiftScores>> turns;
  for (int turn = -turns_each_way; turn <= turns_each_way; ++turn) {
    const double yaw_rad = window.yaw_rad + turn * kTurnStep_rad;
    turns.emplace_back(yaw_rad, ShiftScores(grid, points_m, yaw_rad, reach));
  }
  std::vector<PlacedPoints> result;
  const auto add = [&](const Peak& peak) {
    if (peak.score == 0) return;
    result.push_back(
        {pose_from_xyz_rpy({peak.dx * kCell_m, peak.dy * kCell_m, 0.0}, 0.0, 0.0, peak.yaw_rad),
         peak.score / (2.0 * static_cast<double>(points_m.size()))});
  };
  const Peak best = best_of(turns, reach, nullptr);
  add(best);
  add(best_of(turns, reach, &best));
  return result;
}

std::vector<Eigen::Vector3f> upright_structure_m(const std::vector<Eigen::Vector3f>& points_m) {
  struct Column {
    float low_m = std::numeric_limits<float>::infinity();
    float high_m = -low_m;
  };
  std::vector<Column> columns(static_cast<std::size_t>(kSide) * kSide);
  const auto column_of = [&](const Eigen::Vector3f& point_m) -> Column* {
    const int x = cell_of(point_m.x());
    const int y = cell_of(point_m.y());
    return inside(x, y) ? &columns[index_of(x, y)] : nullptr;
  };
  for (const Eigen::Vector3f& point_m : points_m) {
    Column* column = column_of(point_m);
    if (column == nullptr) continue;
    column->low_m = std::min(column->low_m, point_m.z());
    column->high_m = std::max(column->high_m, point_m.z());
  }
  std::vector<Eigen::Vector3f> result;
  for (const Eigen::Vector3f& point_m : points_m) {
    const Column* column = column_of(point_m);
    if (column != nullptr && column->high_m - column->low_m >= kMinUprightHeight_m) {
      result.push_back(point_m);
    }
  }
  return result;
}

}  // namespace hqslam::slam
