#include "true_place.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "echo.h"

namespace hqslam::sim {

namespace {

constexpr double kAbove_m = 50.0;
constexpr double kDepth_m = 100.0;
constexpr double kBehind_m = 1e-3;  ///< a surface, the search continues

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

/// Tests spheres about the column's axis: their union is the column, except for dents of a seventh
/// of its radius.
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

/// A point this near is on the surface, up to the sensor's noise; no surface behind glass is
/// nearer.
constexpr double kOnSurface_m = 0.03;
/// Windows are ignored from farther away, where they are seen obliquely or faintly.
constexpr double kFarthestPlace_m = 50.0;
/// No room is deeper, seen obliquely.
constexpr double kDeepest_m = 18.0;

double distance_through_glass_m(const RayScene& scene, const Eigen::Vector3d& place_m,
                                const Eigen::Vector3d& point_m, double reach_m) {
  const Eigen::Vector3d to_point_m = point_m - place_m;
  const double range_m = to_point_m.norm();
  if (range_m > kFarthestPlace_m || range_m < 1e-3) return std::numeric_limits<double>::infinity();
  const auto hit = scene.cast(place_m, to_point_m / range_m, 0.0, range_m + reach_m);
  if (!hit || !is_glass(hit->surface.material) || range_m > hit->range_m + kDeepest_m) {
    return std::numeric_limits<double>::infinity();
  }
  return std::abs(range_m - range_through_glass_m(*hit));
}

}  // namespace

std::optional<TruePlace> true_place(const RayScene& scene, const Eigen::Vector3d& point_m,
                                    const UprightColumn& column) {
  const std::optional<double> ground_m = lowest_surface_m(scene, point_m);
  if (!ground_m) return std::nullopt;
  const Eigen::Vector3d bottom_m(point_m.x(), point_m.y(), *ground_m + column.lowest_m);
  return TruePlace{*ground_m, is_occupied(scene, bottom_m, column)};
}

double distance_to_true_surface_m(const RayScene& scene,
                                  const std::vector<Eigen::Vector3d>& places_m,
                                  const Eigen::Vector3d& point_m, double reach_m) {
  double nearest_m =
      scene.distance_m(point_m, reach_m).value_or(std::numeric_limits<double>::infinity());
  for (const Eigen::Vector3d& place_m : places_m) {
    if (nearest_m <= kOnSurface_m) break;
    nearest_m = std::min(nearest_m, distance_through_glass_m(scene, place_m, point_m, reach_m));
  }
  return nearest_m < reach_m ? nearest_m : std::numeric_limits<double>::infinity();
}

}  // namespace hqslam::sim
