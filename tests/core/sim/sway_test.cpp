#include "sway.h"

#include <doctest/doctest.h>

#include <cmath>

#include "driver_path.h"

using namespace hqslam;
using namespace hqslam::sim;

namespace {

/// A car with a sensor on its roof, on its way.
struct Ride {
  DriveStyle style;
  Layout layout;
  DriverPath path;
  VehicleSway sway{6, {}};

  Ride(const char* name, double duration_s)
      : style(drive_style(name)),
        layout(make_layout(style.city, 5)),
        path(plan_path(layout, style.driver, 5, duration_s)) {}
  Pose T_world_sensor(double time_s) const {
    const PathState state = path.at_time(time_s);
    return layout.terrain.frame(state.plane_m, state.heading_rad) *
           sway.T_vehicle_sensor(state.along_m);
  }
};

}  // namespace

TEST_CASE("the sensor stays at its height over the street and moves without jerks of its pose") {
  const Ride ride("hills", 120.0);
  constexpr double kStep_s = 0.01;
  Pose before = ride.T_world_sensor(0.0);
  Pose here = ride.T_world_sensor(kStep_s);
  for (double time_s = 2.0 * kStep_s; time_s < 120.0; time_s += kStep_s) {
    const Pose after = ride.T_world_sensor(time_s);
    const Eigen::Vector3d acceleration =
        (after.translation() - 2.0 * here.translation() + before.translation()) /
        (kStep_s * kStep_s);
    REQUIRE(acceleration.norm() < 12.0);
    const Pose turn = (before.inverse() * here).inverse() * (here.inverse() * after);
    REQUIRE(rotation_angle_rad(turn) / (kStep_s * kStep_s) < 6.0);
    const double height_m =
        after.translation().z() - ride.layout.terrain.height_m(after.translation().head<2>());
    REQUIRE(std::abs(height_m - SensorMount{}.sensor_height_m) < 0.12);
    before = here;
    here = after;
  }
}

TEST_CASE("a standing car stands still") {
  const Ride ride("block", 20.0);
  CHECK(ride.T_world_sensor(0.0).isApprox(ride.T_world_sensor(0.3), 1e-15));
}
