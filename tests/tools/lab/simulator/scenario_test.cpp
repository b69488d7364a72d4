#include "scenario.h"

#include "ray_scene.h"
#include "testing.h"

using namespace hqslam::sim;

namespace {

constexpr double kStep_s = 0.05;

/// A drive, sampled every kStep_s of its first `duration_s`.
struct SampledDrive {
  Scenario scenario;
  std::vector<Pose> T_world_sensor;
  double length_m = 0.0;
  // The largest of the first and second differences.
  double fastest_mps = 0.0;
  double acceleration_mps2 = 0.0;
  double angular_acceleration_rad_per_s2 = 0.0;
  double sideways_share = 0.0;  ///< of the largest step aside

  SampledDrive(const std::string& name, std::uint64_t seed, double duration_s) {
    DriveSpec spec = drive_preset(name);
    spec.seed = seed;
    scenario = make_scenario(spec, duration_s);
    auto& T = T_world_sensor;
    for (double time_s = 0.0; time_s < duration_s; time_s += kStep_s) {
      T.push_back(scenario.T_world_sensor(time_s));
      if (T.size() < 3) continue;
      const std::size_t k = T.size() - 2;
      const Eigen::Vector3d step_m = T[k].translation() - T[k - 1].translation();
      const double aside_m = (T[k - 1].inverse() * T[k]).translation().y();
      const Eigen::Vector3d next_m = T[k + 1].translation() - T[k].translation();
      const Pose turn = (T[k - 1].inverse() * T[k]).inverse() * (T[k].inverse() * T[k + 1]);
      const auto raise = [](double& largest, double value) { largest = std::max(largest, value); };
      length_m += step_m.norm();
      if (step_m.norm() > kStep_s) raise(sideways_share, std::abs(aside_m) / step_m.norm());
      raise(fastest_mps, step_m.norm() / kStep_s);
      raise(acceleration_mps2, (next_m - step_m).norm() / kStep_s / kStep_s);
      raise(angular_acceleration_rad_per_s2, rotation_angle_rad(turn) / kStep_s / kStep_s);
    }
  }
};

/// How near the sensor comes to anything that stands still, level and at every meter or so; 0 if
/// something stands between where it was and where it is next.
double clearance_m(const SampledDrive& drive) {
  const RayScene scene(*drive.scenario.scenery);
  double nearest_m = 100.0;
  Eigen::Vector3d last_m = drive.T_world_sensor.front().translation();
  for (const Pose& pose : drive.T_world_sensor) {
    const Eigen::Vector3d here_m = pose.translation();
    const Eigen::Vector3d way_m = here_m - last_m;
    if (way_m.norm() < 0.5) continue;
    if (scene.cast(last_m, way_m.normalized(), 0.0, way_m.norm())) return 0.0;
    for (int k = 0; k < 24; ++k) {
      const double angle_rad = 2.0 * std::numbers::pi * k / 24;
      const auto hit =
          scene.cast(here_m, {std::cos(angle_rad), std::sin(angle_rad), 0.0}, 0.0, nearest_m);
      if (hit) nearest_m = hit->range_m;
    }
    last_m = here_m;
  }
  return nearest_m;
}

struct Expectation {
  std::string drive;
  double fastest_mps;
  double acceleration_mps2;
  double angular_acceleration_rad_per_s2;
  double clearance_m;
  double sideways_share = 1.0;  ///< a hand goes where it wants
};

}  // namespace

TEST_CASE("every drive moves smoothly, at its pace, clear of what stands, a car where it looks") {
  const std::vector<Expectation> expectations = {
      {"block", 10.5, 4.3, 1.3, 1.2, 0.03}, {"town", 15.0, 4.0, 1.1, 1.2, 0.03},
      {"hills", 20.0, 6.2, 1.9, 1.0, 0.03}, {"meadow", 20.5, 4.5, 1.5, 2.0, 0.03},
      {"narrow", 9.5, 4.0, 1.2, 1.2, 0.03}, {"car-park", 5.8, 4.0, 1.2, 1.2, 0.03},
      {"handheld", 1.8, 5.5, 13.0, 1.2},    {"handheld-turning", 1.8, 5.5, 25.0, 1.2},
      {"indoors", 1.3, 6.0, 6.0, 0.3},
  };
  for (const Expectation& expected : expectations) {
    for (const std::uint64_t seed : {1, 2}) {
      CAPTURE(expected.drive);
      CAPTURE(seed);
      const SampledDrive drive(expected.drive, seed, 180.0);
      CHECK(drive.fastest_mps < expected.fastest_mps);
      CHECK(drive.length_m > 0.35 * 180.0 * expected.fastest_mps);
      CHECK(drive.acceleration_mps2 < expected.acceleration_mps2);
      CHECK(drive.angular_acceleration_rad_per_s2 < expected.angular_acceleration_rad_per_s2);
      CHECK(drive.sideways_share < expected.sideways_share);
      CHECK(clearance_m(drive) > expected.clearance_m);
    }
  }
}

TEST_CASE("on a car the sensor moves without jerks of its pose and stays at its height") {
  constexpr double kShort_s = 0.01;
  const Scenario scenario = make_scenario(drive_preset("hills"), 120.0);
  const RayScene scene(*scenario.scenery);
  Pose before = scenario.T_world_sensor(0.0);
  Pose here = scenario.T_world_sensor(kShort_s);
  for (double time_s = 2.0 * kShort_s; time_s < 120.0; time_s += kShort_s) {
    const Pose after = scenario.T_world_sensor(time_s);
    const Eigen::Vector3d bend =
        after.translation() - 2.0 * here.translation() + before.translation();
    REQUIRE(bend.norm() / kShort_s / kShort_s < 12.0);
    const Pose turn = (before.inverse() * here).inverse() * (here.inverse() * after);
    REQUIRE(rotation_angle_rad(turn) / kShort_s / kShort_s < 6.0);
    const auto street = scene.cast(after.translation(), {0.0, 0.0, -1.0}, 0.0, 10.0);
    REQUIRE(std::abs(street.value().range_m - SensorMount{}.sensor_height_m) < 0.12);
    before = here;
    here = after;
  }
}

TEST_CASE("cars keep clear of the sensor's car, and some pass it") {
  const DriveStyle style = drive_style("town");
  const Layout layout = make_layout(style.city, 1);
  const DriverPath ego = plan_path(layout, style.driver, 1, 150.0);
  const Traffic traffic(layout, style, ego, 3, 150.0);
  int near = 0;
  for (double time_s = 0.0; time_s < 150.0; time_s += 0.5) {
    const PathState here = ego.at_time(time_s);
    for (const ActorMotion& actor : traffic.actors(time_s, time_s + 0.1, here.plane_m)) {
      if (actor.prototype < kFirstCar || actor.prototype >= kFirstWalker) continue;
      const Eigen::Vector2d away = actor.T_world_at_start.translation().head<2>() - here.plane_m;
      CHECK(away.norm() > 2.2);
      if (away.norm() < 30.0) ++near;
    }
  }
  CHECK(near > 20);
}
