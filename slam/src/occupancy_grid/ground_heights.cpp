#include "occupancy_grid/ground_heights.h"

#include <algorithm>
#include <cmath>

namespace hqslam::slam {

namespace {

constexpr double kReach_m = 3.0;
constexpr double kSteepest = 0.25;
/// Fewer points in a cell may be a car's bumper, or a reflection below the street.
constexpr std::uint32_t kFewestPoints = 3;

}  // namespace

void GroundHeights::add(const Eigen::Vector3d& point_m) {
  Sum& sum = sums_.find_or_add(cell_of(point_m.head<2>()));
  sum.height_sum_mm += std::llround(1e3 * point_m.z());
  ++sum.points;
}

std::optional<double> GroundHeights::at(const Eigen::Vector2d& place_m) const {
  if (!(place_m.cwiseAbs().array() < kFarthest_m).all()) return std::nullopt;
  const Height* const height = heights_.find(cell_of(place_m));
  if (height == nullptr || !height->is_known) return std::nullopt;
  return height->m;
}

void GroundHeights::lower(const Eigen::Vector2i& cell, double height_m) {
  Height& height = heights_.find_or_add(cell);
  const auto metres = static_cast<float>(height_m);
  height.m = height.is_known ? std::min(height.m, metres) : metres;
  height.is_known = true;
}

void GroundHeights::settle() {
  constexpr int kReach = static_cast<int>(kReach_m / kCell_m);
  sums_.for_each([&](const Eigen::Vector2i& cell, const Sum& sum) {
    if (sum.points < kFewestPoints) return;
    const double mean_m = 1e-3 * static_cast<double>(sum.height_sum_mm) / sum.points;
    for (int dy = -kReach; dy <= kReach; ++dy) {
      for (int dx = -kReach; dx <= kReach; ++dx) {
        const double distance_m = kCell_m * std::hypot(dx, dy);
        if (distance_m > kReach_m) continue;
        lower(cell + Eigen::Vector2i(dx, dy), mean_m + kSteepest * distance_m);
      }
    }
  });
  sums_ = {};
}

}  // namespace hqslam::slam
