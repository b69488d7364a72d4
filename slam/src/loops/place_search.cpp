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
constexpr int kMostShift = 16;  // in cells
constexpr int kShifts = 2 * kMostShift + 1;
constexpr double kTurnStep_rad = 0.035;  // 0.5 m in 15 m
constexpr int kTurnsEachWay = 3;         // scan contexts measure a rotation to one sector
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

std::size_t index_of_shift(int dx, int dy) {
  return static_cast<std::size_t>(dx + kMostShift) * kShifts + dy + kMostShift;
}

/// The scores of all shifts, in cells of the grid, for one rotation.
std::vector<int> shift_scores(const std::vector<std::uint8_t>& grid,
                              const std::vector<Eigen::Vector3f>& points_m, double yaw_rad) {
  std::vector<int> scores(std::size_t{kShifts} * kShifts, 0);
  const Eigen::Rotation2Df turn(static_cast<float>(yaw_rad));
  for (const Eigen::Vector3f& point_m : points_m) {
    const Eigen::Vector2f turned_m = turn * point_m.head<2>();
    const int x = cell_of(turned_m.x());
    const int y = cell_of(turned_m.y());
    if (!inside(x - kMostShift, y - kMostShift) || !inside(x + kMostShift, y + kMostShift))
      continue;
    for (int dx = -kMostShift; dx <= kMostShift; ++dx) {
      const std::uint8_t* row = &grid[index_of(x + dx, y - kMostShift)];
      int* score = &scores[index_of_shift(dx, -kMostShift)];
      for (int i = 0; i < kShifts; ++i) score[i] += row[i];
    }
  }
  return scores;
}

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
Peak best_of(const std::vector<std::pair<double, std::vector<int>>>& turns, const Peak* taken) {
  Peak best;
  for (const auto& [yaw_rad, scores] : turns) {
    for (int dx = -kMostShift; dx <= kMostShift; ++dx) {
      for (int dy = -kMostShift; dy <= kMostShift; ++dy) {
        const Peak peak{scores[index_of_shift(dx, dy)], dx, dy, yaw_rad};
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
                                       double yaw_rad) {
  const std::vector<std::uint8_t> grid = drawn(structure_m);
  std::vector<std::pair<double, std::vector<int>>> turns;
  for (int turn = -kTurnsEachWay; turn <= kTurnsEachWay; ++turn) {
    const double turned_rad = yaw_rad + turn * kTurnStep_rad;
    turns.emplace_back(turned_rad, shift_scores(grid, points_m, turned_rad));
  }
  std::vector<PlacedPoints> result;
  const auto add = [&](const Peak& peak) {
    if (peak.score == 0) return;
    result.push_back(
        {pose_from_xyz_rpy({peak.dx * kCell_m, peak.dy * kCell_m, 0.0}, 0.0, 0.0, peak.yaw_rad),
         peak.score / (2.0 * static_cast<double>(points_m.size()))});
  };
  const Peak best = best_of(turns, nullptr);
  add(best);
  add(best_of(turns, &best));
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
