#include "loops/loop_verification.h"

#include "slam/village.h"

using namespace hqslam::slam;

namespace {

const SensorModel kSensor = small_sensor(16, 512);

/// The map of a place from poses along a street through it.
Mapping map_of(const auto& scene, const SensorModel& sensor = kSensor) {
  Mapping mapping{MappingOptions{}};
  for (double x_m = -12.0; x_m <= 12.0; x_m += 2.0) {
    const Pose pose = yard_pose(x_m, 0.0, 0.0);
    mapping.insert(features_of(scene.scan(sensor, pose), sensor), pose, {});
  }
  return mapping;
}

}  // namespace

TEST_CASE("a place is accepted from half a metre away, and the pose is found to centimetres") {
  const Mapping map = map_of(street(1, -50.0, 100.0));
  const Pose truth = yard_pose(1.0, 0.7, 0.3);
  const auto features = features_of(street(1, -50.0, 100.0).scan(kSensor, truth), kSensor);
  for (const double yaw_error_rad : {-0.03, 0.03}) {
    const Pose start = truth * pose_from_xyz_rpy({0.4, -0.3, 0.2}, 0.01, -0.01, yaw_error_rad);
    const auto loop = verify_loop(features, map, start).value();
    CHECK(loop.fit.overlap > 0.7);
    CHECK((loop.T_map_sensor.translation() - truth.translation()).norm() < 0.05);
    CHECK(rotation_angle_rad(truth.inverse() * loop.T_map_sensor) < 0.005);
  }
}

TEST_CASE("other places are refused") {
  const Mapping map = map_of(street(1, -50.0, 100.0));
  const Pose pose = yard_pose(0.0, 0.0, 0.0);
  for (const unsigned seed : {2U, 3U, 4U, 5U, 6U}) {
    const auto features = features_of(street(seed, -50.0, 100.0).scan(kSensor, pose), kSensor);
    CAPTURE(seed);
    CHECK_FALSE(verify_loop(features, map, pose));
  }
}

TEST_CASE("a place that fits but could slide is refused") {
  const Yard corridor{.half_width_m = 4.0, .pillars = false, .end_walls = false};
  // With 16 rows the registration is degenerate, with 64 it converges at a random place.
  for (const auto& size : {std::pair{16, 512}, {16, 1024}, {64, 1024}}) {
    const int rows = size.first;
    const SensorModel sensor = small_sensor(rows, size.second);
    CAPTURE(rows);
    const Mapping map = map_of(corridor, sensor);
    const auto features = features_of(corridor.scan(sensor, yard_pose(0.5, 0.2, 0.0)), sensor);
    const Pose start = yard_pose(0.9, 0.2, 0.0);
    CHECK(fit_of(features, map.map(), unknown_motion(start)).overlap > 0.5);
    CHECK_FALSE(verify_loop(features, map, start));
  }
}

TEST_CASE("where there is no map nothing is recognized") {
  const Mapping nothing{MappingOptions{}};
  const Pose pose = yard_pose(0.0, 0.0, 0.0);
  const auto features = features_of(street(1, -50.0, 100.0).scan(kSensor, pose), kSensor);
  CHECK_FALSE(verify_loop(features, nothing, pose));
  CHECK(fit_of(features, nothing.map(), unknown_motion(pose)).overlap == 0.0);
}

TEST_CASE("the fit counts edges and surfaces, by hand") {
  // A wall at x = 5 m; three features: 0.1 m before it, on it, and 2 m before it.
  Mapping map{MappingOptions{}};
  MapFeatures wall;
  for (float y_m = 0.0F; y_m < 5.0F; y_m += 0.5F) {
    for (float z_m = 0.0F; z_m < 5.0F; z_m += 0.5F) {
      wall.surfaces.push_back({{5.0F, y_m, z_m}, 0.0F, 0});
    }
  }
  map.insert(wall, Pose::Identity(), {});
  MapFeatures features;
  features.surfaces_to_register = {
      {{4.9F, 2.2F, 2.2F}, 0.0F, 0}, {{5.0F, 2.2F, 3.2F}, 0.0F, 0}, {{3.0F, 2.2F, 2.2F}, 0.0F, 0}};
  const Fit fit = fit_of(features, map.map(), {});
  CHECK(fit.overlap == doctest::Approx(2.0 / 3.0));
  CHECK(fit.residual_m == doctest::Approx(0.1 / std::sqrt(2.0)).epsilon(1e-3));
  // Seen 0.1 s after and before the stamp, when the sensor was a metre nearer and farther away.
  features.surfaces_to_register = {{{4.0F, 2.2F, 2.2F}, 0.1F, 0}, {{6.0F, 2.2F, 3.2F}, -0.1F, 0}};
  MotionState driving;
  driving.velocity.linear.x() = 10.0;
  CHECK(fit_of(features, map.map(), driving).overlap == 1.0);
}
