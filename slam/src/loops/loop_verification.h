#pragma once

#include <optional>

#include "map/mapping.h"

namespace hqslam::slam {

/// How well features fit a map at a pose.
struct Fit {
  double overlap = 0.0;     ///< share of edges and surfaces on a line or plane of the map
  double residual_m = 0.0;  ///< root mean square of their distances
};
/// Features are corrected for the state's motion. The ground is left out: it fits everywhere.
Fit fit_of(const MapFeatures& features, const FeatureMaps& map, const MotionState& state);

struct VerifiedLoop {
  Pose T_map_sensor = Pose::Identity();
  Fit fit;
};

/// Whether the sensor is at a place.
///
/// In: the recent features (RecentFeatures), the older map of the place, a pose to start from. Out:
/// the registered pose, or nothing if the place is rejected: few matches, no convergence, little
/// overlap, large residuals, or a direction in which the pose can slide. The registration is that
/// of any scan (Mapping::register_scan); the test is stricter, by distances from lines and planes.
std::optional<VerifiedLoop> verify_loop(const MapFeatures& features, const Mapping& older_map,
                                        const Pose& T_map_sensor_start);

}  // namespace hqslam::slam
