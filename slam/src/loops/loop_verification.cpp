#include "loops/loop_verification.h"

#include <cmath>
#include <optional>

#include "front_end/motion_correction.h"
#include "map/map_matching.h"

namespace hqslam::slam {

namespace {

/// A feature farther than this from its line or plane does not fit.
constexpr double kMaxDistance_m = 0.15;
constexpr double kMaxPlaneResidual_m = 0.2;

// Measured with 16 rows, also with distorted scans: 0.36 to 0.66 and 0.04 to 0.07 m at the same
// place, up to 0.33 and 0.08 m and more at other places and wrong poses.
constexpr double kMinOverlap = 0.38;
constexpr double kMaxResidual_m = 0.08;

/// A pose that cannot slide returns from the first displacement to within the second.
constexpr double kPush_m = 1.0;
constexpr double kMaxReturn_m = 0.15;

class FitSum {
 public:
  void add(std::optional<double> distance_m) {
    ++features_;
    if (!distance_m || *distance_m > kMaxDistance_m) return;
    ++fitting_;
    squares_m2_ += *distance_m * *distance_m;
  }
  Fit result() const {
    if (fitting_ == 0) return {};
    return {static_cast<double>(fitting_) / features_, std::sqrt(squares_m2_ / fitting_)};
  }

 private:
  int features_ = 0;
  int fitting_ = 0;
  double squares_m2_ = 0.0;
};

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
    if ((returned.translation() - T_map_sensor.translation()).norm() > kMaxReturn_m) return true;
  }
  return false;
}

}  // namespace

Fit fit_of(const MapFeatures& features, const FeatureMaps& map, const MotionState& state) {
  FitSum sum;
  for (const Eigen::Vector3f& edge_m : motion_corrected(features.edges, state.velocity)) {
    const Eigen::Vector3d point_m = state.T_map_sensor * edge_m.cast<double>();
    const auto line = fit_line(map.edges.nearest(point_m.cast<float>()));
    sum.add(line ? std::optional(line->direction.cross(point_m - line->point_m).norm())
                 : std::nullopt);
  }
  for (const Eigen::Vector3f& surface_m :
       motion_corrected(features.surfaces_to_register, state.velocity)) {
    const Eigen::Vector3d point_m = state.T_map_sensor * surface_m.cast<double>();
    const auto plane = fit_plane(map.planes.nearest(point_m.cast<float>()), kMaxPlaneResidual_m);
    sum.add(plane ? std::optional(std::abs(plane->normal.dot(point_m - plane->point_m)))
                  : std::nullopt);
  }
  return sum.result();
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
