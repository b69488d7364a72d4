#pragma once

#include "map/mapping.h"

namespace hqslam::slam {

/// What is known of a scan before it is looked for in the map.
struct ExpectedScan {
  MotionState state;  ///< from the scan before, if it goes on as it did
  Pose T_map_moved;   ///< where the odometry saw it
  double duration_s;  ///< since the scan before
};

/// Whether a state is known so well that a scan is looked for there and nowhere else, unless the
/// odometry contradicts.
bool is_precise(const MotionState& state);

/// Registers a scan from where it is expected; and if little is known about that, or the odometry
/// saw it elsewhere, from there too. Of the two places the one is taken that more of what stands on
/// the ground fits.
MappingResult register_from_both(const Mapping& mapping, const MapFeatures& features,
                                 const ExpectedScan& expected);

}  // namespace hqslam::slam
