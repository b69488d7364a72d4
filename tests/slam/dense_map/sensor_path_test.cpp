#include "hqslam/slam/sensor_path.h"

#include "testing.h"

using namespace hqslam::slam;

namespace {

StampedPose pose_at(double stamp_s, double x_m, double yaw_rad = 0.0) {
  return {stamp_s, pose_from_xyz_rpy({x_m, 0.0, 0.0}, 0.0, 0.0, yaw_rad)};
}

}  // namespace

TEST_CASE("between stamps the sensor moves evenly, at another pace before than after") {
  const Trajectory trajectory = {pose_at(0.0, 0.0), pose_at(0.1, 1.0), pose_at(0.2, 3.0, 0.2)};
  const SensorPath path(trajectory, 1);
  CHECK(path.at(0.0).translation().x() == 1.0);
  CHECK(path.at(-0.05).translation().x() == doctest::Approx(0.5));
  CHECK(path.at(0.05).translation().x() == doctest::Approx(2.0));
  CHECK(roll_pitch_yaw_rad(path.at(0.05)).z() == doctest::Approx(0.1));
  CHECK(path.at(0.1).isApprox(trajectory[2].T_map_sensor));
  CHECK(path.at(-0.1).isApprox(trajectory[0].T_map_sensor));
}

TEST_CASE("at the ends, and beside a stamp that does not rise, the other side's motion goes on") {
  const Trajectory trajectory = {pose_at(0.0, 0.0), pose_at(0.1, 1.0), pose_at(0.1, 7.0)};
  CHECK(SensorPath(trajectory, 0).at(-0.05).translation().x() == doctest::Approx(-0.5));
  CHECK(SensorPath(trajectory, 1).at(0.05).translation().x() == doctest::Approx(1.5));
  CHECK(SensorPath(trajectory, 2).at(0.05).translation().x() == 7.0);
  CHECK(SensorPath({pose_at(0.0, 2.0)}, 0).at(0.05).translation().x() == 2.0);
  CHECK(refused_with([] { SensorPath({pose_at(0.0, 0.0)}, 1); }, "scan 1", "trajectory of 1"));
}
