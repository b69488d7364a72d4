#include "true_place.h"

namespace hqslam::sim {

namespace {

constexpr double kAbove_m = 50.0;
constexpr double kDepth_m = 100.0;
constexpr double kBehind_m = 1e-3;  ///< a surface the ray goes on

std::optional<double> lowest_surface_m(const RayScene& scene, const Eigen::Vector3d& point_m) {
  const double top_m = point_m.z() + kAbove_m;
  std::optional<double> lowest_m;
  for (double at_m = 0.0; at_m < kDepth_m;) {
    const auto hit = scene.cast({point_m.x(), point_m.y(), top_m - at_m}, -Eigen::Vector3d::UnitZ(),
                                0.0, kDepth_m - at_m);
    if (!hit) break;
    at_m += hit->range_m;
    lowest_m = top_m - at_m;
    at_m += kBehind_m;
  }
  return lowest_m;
}

/// As spheres about its axis: their union is the column, but for dents of a seventh of its radius.
bool is_occupied(const RayScene& scene, const Eigen::Vector3d& bottom_m,
                 const UprightColumn& column) {
  const double height_m = column.highest_m - column.lowest_m;
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  // Most columns are empty, and so is a sphere about all of it.
  if (!scene.distance_m(bottom_m + 0.5 * height_m * up, 0.5 * height_m + column.radius_m)) {
    return false;
  }
  for (double at_m = 0.0; at_m <= height_m; at_m += column.radius_m) {
    if (scene.distance_m(bottom_m + at_m * up, column.radius_m)) return true;
  }
  return false;
}

}  // namespace

std::optional<TruePlace> true_place(const RayScene& scene, const Eigen::Vector3d& point_m,
                                    const UprightColumn& column) {
  const std::optional<double> ground_m = lowest_surface_m(scene, point_m);
  if (!ground_m) return std::nullopt;
  const Eigen::Vector3d bottom_m(point_m.x(), point_m.y(), *ground_m + column.lowest_m);
  return TruePlace{*ground_m, is_occupied(scene, bottom_m, column)};
}

}  // namespace hqslam::sim
