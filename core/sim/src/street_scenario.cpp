#include "carried_motion.h"
#include "path_plan.h"
#include "scenario.h"
#include "vehicle_motion.h"

namespace hqslam::sim {

namespace {

class StreetScenario final : public Scenario {
 public:
  StreetScenario(const DriveSpec& spec, double duration_s)
      : style_(drive_style(spec.name)),
        city_(make_city(style_.city, seed_of_part(spec.seed, DrivePart::kCity))),
        path_(plan_path(city_.layout, style_.driver, spec.seed, duration_s)),
        motion_(make_motion(spec)),
        traffic_(city_.layout, style_, path_, seed_of_part(spec.seed, DrivePart::kTraffic),
                 duration_s) {}

  const Scenery& scenery() const override { return city_; }
  Pose T_world_sensor(double time_s) const override { return motion_->T_world_sensor(time_s); }
  std::vector<ActorMotion> actors(double from_s, double to_s,
                                  const Eigen::Vector2d& plane_m) const override {
    return traffic_.actors(from_s, to_s, plane_m);
  }

 private:
  std::unique_ptr<SensorMotion> make_motion(const DriveSpec& spec) const {
    const std::uint64_t seed = seed_of_part(spec.seed, DrivePart::kSway);
    const Terrain& terrain = city_.layout.terrain;
    if (style_.carrier == Carrier::kHand) {
      return std::make_unique<CarriedMotion>(path_, terrain, spec.mount, seed);
    }
    return std::make_unique<VehicleMotion>(path_, terrain, spec.mount, seed);
  }

  DriveStyle style_;
  City city_;
  DriverPath path_;
  std::unique_ptr<SensorMotion> motion_;
  Traffic traffic_;
};

}  // namespace

std::unique_ptr<Scenario> make_street_scenario(const DriveSpec& spec, double duration_s) {
  return std::make_unique<StreetScenario>(spec, duration_s);
}

}  // namespace hqslam::sim
