#pragma once

#include "map/mapping.h"

namespace hqslam::slam {

/// What is known of a scan before it is looked for in the map.
struct ExpectedScan {
  MotionState state;        ///< from the scan before, if it goes on as it did
  Pose T_map_moved;         ///< where the odometry saw it
  Pose T_map_last;          ///< where the scan before was taken
  double duration_s;        ///< since the scan before
  double last_close_ratio;  ///< MappingResult::close_ratio of the last registered scan
  bool is_turn_measured;    ///< by an inertial sensor: the scan is not looked for at other turns
};

/// Whether a state is known so well that a scan is looked for there and nowhere else, unless the
/// odometry contradicts.
bool is_precise(const MotionState& state);

/// Registers a scan from where it is expected; if little is known about that, or the odometry saw
/// it elsewhere, from there too; and if what was found fits badly, from six turns beside the
/// expected pose, and then from the last one and six beside that: a hand that goes back is nearer
/// to where it was than to where it was going. Of all places the one is taken that most of the
/// scan's features lie close to.
MappingResult register_from_starts(const Mapping& mapping, const MapFeatures& features,
                                   const ExpectedScan& expected);

}  // namespace hqslam::slam
