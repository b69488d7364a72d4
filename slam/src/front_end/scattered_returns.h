#pragma once

#include <optional>

#include "hqslam/core/organized_cloud.h"

namespace hqslam::slam {

/// Echoes of droplets and flakes are nearer. What stands alone farther away is kept: fog thins
/// surfaces, too, and along a street those that are far away carry the motion (a raw HDL-64E in
/// made fog).
inline constexpr float kFarthestEcho_m = 10.0F;

/// A scan through fog, dust or snow without the echoes of droplets and flakes, which would travel
/// with the sensor; nothing for a scan in clear air.
///
/// A return is scattered if fewer than two of its neighbours (three columns to each side in its
/// row, one above and below) are at its range, within a tenth of it or 0.3 m. In clear air these
/// are up to 2 % of the returns (16 and 64 rows; streets, hills, meadows, rooms, real and
/// simulated), in fog with a visibility of 40 m 23 to 62 %. A scan with more than 10 % loses all
/// returns within 10 m of which fewer than three neighbours (six columns, two above and below) are
/// within a twentieth of their range or 0.15 m.
std::optional<OrganizedCloud> without_scattered(const OrganizedCloud& cloud);

/// Whether many single returns fail on surfaces, as in fog, dust and snow and in clouds that were
/// thinned out: pixels without a return between two of one range.
bool has_failing_returns(const OrganizedCloud& cloud);

}  // namespace hqslam::slam
