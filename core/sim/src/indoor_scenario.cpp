#include <cmath>

#include "b_spline.h"
#include "indoor_plan.h"
#include "random.h"
#include "scenario.h"
#include "sway.h"

namespace hqslam::sim {

namespace {

constexpr double kPace_mps = 1.0;
constexpr double kAcceleration_mps2 = 0.8;
constexpr double kStandStill_s = 0.5;
constexpr HandStyle kHand = {.swing_rad = 0.06};
constexpr double kSpare_m = 10.0;  ///< corners are cut, and the spline needs some points

/// The way of somebody who walks on floors and stairs: a polyline with rounded corners, as control
/// points of a uniform cubic B-spline every quarter of a metre. After half a second they start and
/// then keep their pace. A longer polyline begins with the same way as a shorter one.
class WalkingPath {
 public:
  explicit WalkingPath(const std::vector<Eigen::Vector3d>& waypoints_m)
      : control_m_(resampled(waypoints_m, kSpacing_m).points) {
    constexpr int kSmoothingPasses = 8;
    smooth(control_m_, kSmoothingPasses);
  }

  /// The walker's feet, upright, x forward.
  Pose T_world_walker(double time_s) const {
    const double since_s = std::max(0.0, time_s - kStandStill_s);
    const double ramp_s = kPace_mps / kAcceleration_mps2;
    const double along_m = since_s < ramp_s ? 0.5 * kAcceleration_mps2 * since_s * since_s
                                            : kPace_mps * (since_s - 0.5 * ramp_s);
    const auto value = spline_at(control_m_, along_m / kSpacing_m);
    return upright_frame(value.position, std::atan2(value.derivative.y(), value.derivative.x()));
  }

 private:
  static constexpr double kSpacing_m = 0.25;
  std::vector<Eigen::Vector3d> control_m_;
};

}  // namespace

Scenario make_indoor_scenario(const DriveSpec& spec, double duration_s) {
  const IndoorPlan plan = make_indoor_plan(seed_of(spec.seed, DrivePart::kCity));
  const WalkingPath path(
      indoor_route(plan, seed_of(spec.seed, DrivePart::kPath), kPace_mps * duration_s + kSpare_m));
  const HandSway sway(seed_of(spec.seed, DrivePart::kSway), kHand, spec.mount);
  const auto building = std::make_shared<Scenery>();
  building->fixed = make_indoor_mesh(plan);
  return {building,
          [path, sway](double time_s) {
            return sway.T_world_sensor(path.T_world_walker(time_s), time_s);
          },
          [](double /*from_s*/, double /*to_s*/, const Eigen::Vector2d& /*plane_m*/) {
            return std::vector<ActorMotion>{};
          }};
}

}  // namespace hqslam::sim
