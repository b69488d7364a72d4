#pragma once

#include "hqslam/sim/drive.h"

namespace hqslam::sim {

/// Calls visit(part, name, value, lowest, highest) for each number of a drive's mount and
/// conditions: the names are drive.json's.
template <typename Spec, typename Visit>
void for_each_number(Spec& spec, const Visit& visit) {
  constexpr double kUpsideDown_rad = 3.1416;
  constexpr double kSteepest_rad = 0.7854;
  visit("mount", "sensor_height_m", spec.mount.sensor_height_m, 0.1, 10.0);
  visit("mount", "mount_roll_rad", spec.mount.mount_roll_rad, -kUpsideDown_rad, kUpsideDown_rad);
  visit("mount", "mount_pitch_rad", spec.mount.mount_pitch_rad, -kSteepest_rad, kSteepest_rad);
  visit("conditions", "extra_range_noise_m", spec.conditions.extra_range_noise_m, 0.0, 1.0);
  visit("conditions", "dropout_share", spec.conditions.dropout_share, 0.0, 0.999);
  visit("conditions", "extinction_per_m", spec.conditions.extinction_per_m, 0.0, 1.0);
  visit("conditions", "airborne_share", spec.conditions.airborne_share, 0.0, 1.0);
}

}  // namespace hqslam::sim
