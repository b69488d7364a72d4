#include <algorithm>

#include "hqslam/sim/drive.h"
#include "path_plan.h"
#include "random.h"

namespace hqslam::sim {

namespace {

constexpr double kRadiansPerDegree = 0.017453292519943295;

/// Normally distributed, cut off at 5 degrees.
double drawn_tilt_rad(Random& random) {
  return kRadiansPerDegree * std::clamp(1.5 * random.normal(), -5.0, 5.0);
}

}  // namespace

DriveSpec with_varied_conditions(DriveSpec spec) {
  Random random(seed_of_part(spec.seed, DrivePart::kConditions));
  spec.mount.sensor_height_m = random.uniform(0.4, 2.2);
  spec.mount.mount_roll_rad = drawn_tilt_rad(random);
  spec.mount.mount_pitch_rad = drawn_tilt_rad(random);
  // Squares: most sensors are good and most days are clear.
  const double noise = random.uniform();
  spec.conditions.extra_range_noise_m = 0.02 * noise * noise;
  const double dropout = random.uniform();
  spec.conditions.dropout_share = 0.06 * dropout * dropout;
  const bool bad_weather = random.chance(0.25);
  const double density = random.uniform();
  const double drops = random.uniform();
  if (bad_weather) {
    spec.conditions.extinction_per_m = 0.002 + 0.028 * density * density;
    spec.conditions.airborne_share = 0.02 * density * drops;
  }
  return spec;
}

}  // namespace hqslam::sim
