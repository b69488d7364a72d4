#include "vehicle_motion.h"

#include <doctest/doctest.h>

#include <cmath>

#include "path_plan.h"

using namespace hqslam;
using namespace hqslam::sim;

TEST_CASE("the sensor stays at its height over the street and moves without jerks of its pose") {
  const DriveStyle style = drive_style("hills");
  const Layout layout = make_layout(style.city, 5);
  const DriverPath path = plan_path(layout, style.driver, 5, 120.0);
  const VehicleMotion motion(path, layout.terrain, {}, 6);
  constexpr double kStep_s = 0.01;
  Pose before = motion.T_world_sensor(0.0);
  Pose here = motion.T_world_sensor(kStep_s);
  for (double time_s = 2.0 * kStep_s; time_s < 120.0; time_s += kStep_s) {
    const Pose after = motion.T_world_sensor(time_s);
    const Eigen::Vector3d acceleration =
        (after.translation() - 2.0 * here.translation() + before.translation()) /
        (kStep_s * kStep_s);
    REQUIRE(acceleration.norm() < 12.0);
    const Pose turn = (before.inverse() * here).inverse() * (here.inverse() * after);
    REQUIRE(rotation_angle_rad(turn) / (kStep_s * kStep_s) < 6.0);
    const double height_m =
        after.translation().z() - layout.terrain.height_m(after.translation().head<2>());
    REQUIRE(std::abs(height_m - SensorMount{}.sensor_height_m) < 0.12);
    before = here;
    here = after;
  }
}

TEST_CASE("a standing car stands still") {
  const DriveStyle style = drive_style("block");
  const Layout layout = make_layout(style.city, 5);
  const DriverPath path = plan_path(layout, style.driver, 5, 20.0);
  const VehicleMotion motion(path, layout.terrain, {}, 6);
  CHECK(motion.T_world_sensor(0.0).isApprox(motion.T_world_sensor(0.3), 1e-15));
}
