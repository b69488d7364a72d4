#include "path_plan.h"

#include "lane.h"
#include "random.h"
#include "route.h"

namespace hqslam::sim {

namespace {

/// Traffic must know where the sensor will be for as long as a car crosses the city.
constexpr double kForesight_s = 200.0;

}  // namespace

std::uint64_t seed_of_part(std::uint64_t drive_seed, DrivePart part) {
  return seed_of(drive_seed, static_cast<std::uint64_t>(part));
}

DriverPath plan_path(const Layout& layout, const DriverStyle& style, std::uint64_t drive_seed,
                     double duration_s) {
  const std::uint64_t seed = seed_of_part(drive_seed, DrivePart::kPath);
  const double length_m = (duration_s + kForesight_s) * style.max_limit_mps;
  const auto route = make_route(layout, style, seed_of(seed, 1), length_m);
  return {lane_along(layout, route, style, seed_of(seed, 2)), style};
}

}  // namespace hqslam::sim
