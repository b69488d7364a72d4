#include "disturbance.h"

#include <cmath>

#include "random.h"

namespace hqslam::sim {

double transmission(double extinction_per_m, double range_m) {
  double left = 1.0 / (1.0 + extinction_per_m * range_m / 8.0);
  for (int doubling = 0; doubling < 4; ++doubling) left *= left;
  return left;
}

float disturbed_range_m(float range_m, const SensingConditions& conditions,
                        const SensorModel& sensor, std::uint64_t random_bits) {
  if (conditions == SensingConditions{}) return range_m;
  Random random(random_bits);
  double disturbed_m = range_m;
  const bool meets_drops = random.chance(conditions.airborne_share);
  const double nearness = random.uniform();
  const double drops_m = sensor.min_range_m + 12.0 * nearness * nearness;
  if (meets_drops && (range_m == 0.0F || drops_m < disturbed_m)) disturbed_m = drops_m;
  const bool lost = random.chance(conditions.dropout_share);
  if (lost || disturbed_m == 0.0) return 0.0F;
  disturbed_m += conditions.extra_range_noise_m * random.normal();
  if (disturbed_m < sensor.min_range_m || disturbed_m > sensor.max_range_m) return 0.0F;
  return static_cast<float>(std::round(disturbed_m * 1000.0) / 1000.0);
}

}  // namespace hqslam::sim
