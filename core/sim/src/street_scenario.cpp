#include "random.h"
#include "scenario.h"
#include "sway.h"

namespace hqslam::sim {

namespace {

constexpr double kTenDegrees_rad = 0.17453292519943295;

class StreetScenario final : public Scenario {
 public:
  StreetScenario(const DriveSpec& spec, double duration_s)
      : style_(drive_style(spec.name)),
        city_(make_city(style_.city, seed_of(spec.seed, DrivePart::kCity))),
        path_(plan_path(city_.layout, style_.driver, spec.seed, duration_s)),
        vehicle_(seed_of(spec.seed, DrivePart::kSway), spec.mount),
        hand_(seed_of(spec.seed, DrivePart::kSway), kTenDegrees_rad, spec.mount),
        traffic_(city_.layout, style_, path_, seed_of(spec.seed, DrivePart::kTraffic), duration_s) {
  }

  const Scenery& scenery() const override { return city_; }
  Pose T_world_sensor(double time_s) const override {
    const PathState state = path_.at_time(time_s);
    const Terrain& terrain = city_.layout.terrain;
    if (style_.carrier == Carrier::kWheels) {
      return terrain.frame(state.plane_m, state.heading_rad) *
             vehicle_.T_vehicle_sensor(state.along_m);
    }
    // Who walks is upright whatever the slope.
    const Pose T_world_walker =
        upright_frame(terrain.ground(state.plane_m, 0.0), state.heading_rad);
    return hand_.T_world_sensor(T_world_walker, time_s);
  }
  std::vector<ActorMotion> actors(double from_s, double to_s,
                                  const Eigen::Vector2d& plane_m) const override {
    return traffic_.actors(from_s, to_s, plane_m);
  }

 private:
  DriveStyle style_;
  City city_;
  DriverPath path_;
  VehicleSway vehicle_;
  HandSway hand_;
  Traffic traffic_;
};

}  // namespace

std::unique_ptr<Scenario> make_street_scenario(const DriveSpec& spec, double duration_s) {
  return std::make_unique<StreetScenario>(spec, duration_s);
}

}  // namespace hqslam::sim
