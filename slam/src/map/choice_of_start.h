#pragma once

#include <functional>

#include "map/mapping.h"

namespace hqslam::slam {

/// What is known about a scan before its registration.
struct ExpectedScan {
  MotionState state;                  ///< predicted from the scan before
  Pose T_map_start;                   ///< the expected one, unless a better one is known
  std::function<Pose()> T_map_moved;  ///< by the odometry, which takes time
  Pose T_map_last;                    ///< of the scan before
  double duration_s;                  ///< since the scan before
  /// MappingResult::close_ratio of the last registered scan; the usual one if state is uncertain.
  double last_close_ratio;
  bool is_turn_measured;  ///< by an inertial sensor: no other headings are tried
  bool is_speed_unknown;  ///< nothing is known of it: other poses are tried
};

/// A scan whose close_ratio is less than this share of the last one's fits badly: other starts are
/// tried, and a registration without the inertial sensor. Chosen on the real handheld OS0.
inline constexpr double kDoubtfulFit = 0.8;
/// The gain in close_ratio by which another registration is better. Chosen on the same.
inline constexpr double kClearlyBetter = 1.1;

/// A scan whose expected state is uncertain may be elsewhere, unless its close_ratio has this share
/// of the usual one: nothing but the fit shows where it is. A real sensor in a hand that turns
/// (OS0, a scan every 1 or 1.5 s, 64, 32 and 16 rows) was found at wrong places with shares of 0.4
/// to 0.75, at right ones with 0.55 and more. In a given map a wrong place is worse: errors do not
/// add up there, so that no later covariance includes it.
inline constexpr double kLeastShareOfUsualFit = 0.5;
inline constexpr double kLeastShareInGivenMap = 0.6;

/// Whether a scan fits clearly better in one place than in another: by a tenth.
bool fits_better(const MappingResult& a, const MappingResult& b);
/// The same, and by more than three times the chance of a count. With returns to 12 m a street (raw
/// HDL-64E) has a hundred features close to the map. A tenth of them is chance, and took the sensor
/// back by a metre.
bool fits_better_than_chance(const MappingResult& a, const MappingResult& b);

/// Whether a state is known well enough to be the only start of a registration that fits.
bool is_precise(const MotionState& state);

/// Registers a scan from its expected pose; from the odometry's pose too, if the expected one is
/// uncertain or the result fits badly; from the expected pose made upright where no ground
/// determines height and tilt, since on stairs treads fit other treads once the pose leans by some
/// degrees; if it still fits badly, from six headings beside the expected pose, and then from the
/// last pose and six headings beside that, since a hand that turns back is nearer to its last pose;
/// and from poses beside the last one, if nothing is known of the speed. The result with most
/// features close to the map wins; it is ambiguous if others fit as well.
MappingResult register_from_starts(const Mapping& mapping, const MapFeatures& features,
                                   const ExpectedScan& expected);

}  // namespace hqslam::slam
