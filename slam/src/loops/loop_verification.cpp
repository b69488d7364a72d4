#include "loops/loop_verification.h"

#include <cmath>
#include <optional>

#include "front_end/motion_correction.h"
#include "map/map_matching.h"

namespace hqslam::slam {

namespace {

/// A feature farther than this from its line or plane does not fit. Chosen in simulation alone.
constexpr double kMaxDistance_m = 0.15;
constexpr double kMaxPlaneResidual_m = 0.2;  // as in LeGO-LOAM

// Simulated, with 16 rows, also with distorted scans: 0.36 to 0.66 and 0.04 to 0.07 m at the same
// place, up to 0.33 and 0.08 m and more at other places and wrong poses.
constexpr double kMinOverlap = 0.38;
constexpr double kMaxResidual_m = 0.08;

/// A pose that cannot slide returns from the first displacement to within the second. Chosen in
/// simulation alone.
constexpr double kPush_m = 1.0;
constexpr double kMaxReturn_m = 0.15;

/// The registration of a standing sensor near a pose.
MappingResult registered_at(const MapFeatures& features, const Mapping& map,
                            const Pose& T_map_sensor) {
  MotionState standing;
  standing.T_map_sensor = T_map_sensor;
  return map.register_scan(features, standing, T_map_sensor, SearchFrom::kRecognizedPlace);
}

/// Whether the pose can slide forwards or sideways: along a corridor every place fits, and the few
/// edges that noise makes of its walls hold the pose anywhere.
bool slides(const MapFeatures& features, const Mapping& older_map, const Pose& T_map_sensor) {
  for (const int axis : {0, 1}) {
    const Pose pushed = T_map_sensor * Eigen::Translation3d(kPush_m * Eigen::Vector3d::Unit(axis));
    const Pose returned = registered_at(features, older_map, pushed).state.T_map_sensor;
    if (distance_m(returned, T_map_sensor) > kMaxReturn_m) return true;
  }
  return false;
}

}  // namespace

Fit fit_of(const MapFeatures& features, const FeatureMaps& map, const MotionState& state) {
  int count = 0;
  int fitting = 0;
  double squares_m2 = 0.0;
  const auto add = [&](const std::vector<FeaturePoint>& kind, const auto& distance_m) {
    for (const Eigen::Vector3f& corrected_m : motion_corrected(kind, state.within_scan())) {
      const Eigen::Vector3d point_m = state.T_map_sensor * corrected_m.cast<double>();
      const std::optional<double> away_m = distance_m(point_m);
      ++count;
      if (!away_m || *away_m > kMaxDistance_m) continue;
      ++fitting;
      squares_m2 += *away_m * *away_m;
    }
  };
  add(features.edges, [&](const Eigen::Vector3d& point_m) -> std::optional<double> {
    const auto line = fit_line(map.edges.nearest(point_m.cast<float>()));
    if (!line) return std::nullopt;
    return line->direction.cross(point_m - line->point_m).norm();
  });
  add(features.surfaces_to_register, [&](const Eigen::Vector3d& point_m) -> std::optional<double> {
    const auto plane = fit_plane(map.planes.nearest(point_m.cast<float>()), kMaxPlaneResidual_m);
    if (!plane) return std::nullopt;
    return std::abs(plane->normal.dot(point_m - plane->point_m));
  });
  if (fitting == 0) return {};
  return {static_cast<double>(fitting) / count, std::sqrt(squares_m2 / fitting)};
}

std::optional<VerifiedLoop> verify_loop(const MapFeatures& features, const Mapping& older_map,
                                        const Pose& T_map_sensor_start) {
  MappingResult found = registered_at(features, older_map, T_map_sensor_start);
  if (found.status == Status::kNotConverged) {
    found = registered_at(features, older_map, found.state.T_map_sensor);
  }
  // A pose that can slide is degenerate, or false edges make it oscillate.
  if (found.status != Status::kOk) return std::nullopt;
  const Fit fit = fit_of(features, older_map.map(), found.state);
  const bool fits = fit.overlap >= kMinOverlap && fit.residual_m <= kMaxResidual_m;
  if (!fits || slides(features, older_map, found.state.T_map_sensor)) return std::nullopt;
  return VerifiedLoop{found.state.T_map_sensor, fit};
}

}  // namespace hqslam::slam
