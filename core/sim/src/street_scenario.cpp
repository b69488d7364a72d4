#include "random.h"
#include "scenario.h"
#include "sway.h"

namespace hqslam::sim {

Scenario make_street_scenario(const DriveSpec& spec, double duration_s) {
  const DriveStyle style = drive_style(spec.name);
  const auto city =
      std::make_shared<const City>(make_city(style.city, seed_of(spec.seed, DrivePart::kCity)));
  const auto path = std::make_shared<const DriverPath>(
      plan_path(city->layout, style.driver, spec.seed, duration_s));
  const auto traffic = std::make_shared<const Traffic>(
      city->layout, style, *path, seed_of(spec.seed, DrivePart::kTraffic), duration_s);
  const std::uint64_t sway_seed = seed_of(spec.seed, DrivePart::kSway);

  Scenario scenario{.scenery = city, .T_world_sensor = {}, .actors = {}};
  // The traffic looks at the city and the path.
  scenario.actors = [city, path, traffic](double from_s, double to_s,
                                          const Eigen::Vector2d& plane_m) {
    return traffic->actors(from_s, to_s, plane_m);
  };
  if (!style.hand) {
    const VehicleSway sway(sway_seed, spec.mount);
    scenario.T_world_sensor = [city, path, sway](double time_s) {
      const PathState state = path->at_time(time_s);
      return Pose(city->layout.terrain.frame(state.plane_m, state.heading_rad) *
                  sway.T_vehicle_sensor(state.along_m));
    };
  } else {
    const HandSway sway(sway_seed, *style.hand, spec.mount);
    scenario.T_world_sensor = [city, path, sway](double time_s) {
      // Who walks is upright whatever the slope.
      const PathState state = path->at_time(time_s);
      const Eigen::Vector3d feet_m = city->layout.terrain.ground(state.plane_m, 0.0);
      return sway.T_world_sensor(upright_frame(feet_m, state.heading_rad), time_s);
    };
  }
  return scenario;
}

}  // namespace hqslam::sim
