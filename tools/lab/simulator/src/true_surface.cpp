#include "true_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "echo.h"

namespace hqslam::sim {

namespace {

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
