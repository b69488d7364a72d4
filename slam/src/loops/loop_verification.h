#pragma once

#include <optional>

#include "map/mapping.h"

namespace hqslam::slam {

/// How well features fit a map at a pose.
struct Fit {
  double overlap = 0.0;     ///< share of edges and surfaces on a line or plane of the map
  double residual_m = 0.0;  ///< root mean square of their distances
};
/// Features are corrected for the state's motion. The ground takes no part: it fits everywhere.
Fit fit_of(const MapFeatures& features, const FeatureMaps& map, const MotionState& state);

struct VerifiedLoop {
  Pose T_map_sensor = Pose::Identity();
  Fit fit;
};

/// Whether a place is the one that the sensor is at.
///
/// In: what the sensor saw lately (RecentFeatures), the map of the place as it was before, a pose
/// to start from. Out: the registered pose, or nothing if the place is refused: too little matched,
/// no pose was settled on, little overlap, large residuals, or some direction could slide.
/// Registered as any scan is (Mapping::register_scan); judged more strictly, by distances from
/// lines and planes.
std::optional<VerifiedLoop> verify_loop(const MapFeatures& features, const Mapping& older_map,
                                        const Pose& T_map_sensor_start);

}  // namespace hqslam::slam
