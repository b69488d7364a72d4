#include "indoor_mesh.h"
#include "random.h"
#include "scenario.h"
#include "sway.h"
#include "walking_path.h"

namespace hqslam::sim {

namespace {

constexpr double kPace_mps = 1.0;
constexpr double kSway_rad = 0.06;
constexpr double kSpare_m = 10.0;  ///< corners are cut, and the spline needs some points

class IndoorScenario final : public Scenario {
 public:
  IndoorScenario(const DriveSpec& spec, double duration_s)
      : plan_(make_indoor_plan(seed_of(spec.seed, DrivePart::kCity))),
        path_(indoor_route(plan_, seed_of(spec.seed, DrivePart::kPath),
                           kPace_mps * duration_s + kSpare_m),
              kPace_mps),
        sway_(seed_of(spec.seed, DrivePart::kSway), kSway_rad, spec.mount),
        scenery_{.fixed = make_indoor_mesh(plan_), .prototypes = {}, .placements = {}} {}

  const Scenery& scenery() const override { return scenery_; }
  Pose T_world_sensor(double time_s) const override {
    return sway_.T_world_sensor(path_.T_world_walker(time_s), time_s);
  }
  std::vector<ActorMotion> actors(double /*from_s*/, double /*to_s*/,
                                  const Eigen::Vector2d& /*plane_m*/) const override {
    return {};
  }

 private:
  IndoorPlan plan_;
  WalkingPath path_;
  HandSway sway_;
  Scenery scenery_;
};

}  // namespace

std::unique_ptr<Scenario> make_indoor_scenario(const DriveSpec& spec, double duration_s) {
  return std::make_unique<IndoorScenario>(spec, duration_s);
}

}  // namespace hqslam::sim
