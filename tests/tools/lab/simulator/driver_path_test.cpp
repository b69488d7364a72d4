#include "driver_path.h"

#include "hqslam/sim/drive.h"
#include "random.h"
#include "testing.h"

using namespace hqslam::sim;

namespace {

/// All of a drive with its usual length and seed.
struct PlannedDrive {
  DriveStyle style;
  Layout layout;
  double duration_s;
  DriverPath path;

  explicit PlannedDrive(const char* name)
      : style(drive_style(name)),
        layout(make_layout(style.city, seed_of(1, DrivePart::kCity))),
        duration_s(0.1 * static_cast<double>(drive_preset(name).scans)),
        path(plan_path(layout, style.driver, 1, duration_s)) {}
};

double turned_rad(double from_rad, double to_rad) {
  return std::remainder(to_rad - from_rad, 2.0 * std::numbers::pi);
}

}  // namespace

TEST_CASE("position, heading and speed along the path are smooth and agree with each other") {
  for (const char* name : {"block", "town", "hills"}) {
    const PlannedDrive drive(name);
    const DriverStyle& style = drive.style.driver;
    constexpr double kStep_s = 0.05;
    double largest_lateral = 0.0;
    for (double time_s = kStep_s; time_s + kStep_s < drive.duration_s; time_s += kStep_s) {
      const PathState before = drive.path.at_time(time_s - kStep_s);
      const PathState here = drive.path.at_time(time_s);
      const PathState after = drive.path.at_time(time_s + kStep_s);
      const Eigen::Vector2d velocity = (after.plane_m - before.plane_m) / (2.0 * kStep_s);
      REQUIRE(std::abs(velocity.norm() - here.speed_mps) < 0.15);
      const double change = (after.speed_mps - here.speed_mps) / kStep_s;
      REQUIRE(change < style.acceleration_mps2 + 0.8);
      REQUIRE(change > -style.braking_mps2 - 0.8);
      const double yaw_rate = turned_rad(before.heading_rad, after.heading_rad) / (2.0 * kStep_s);
      largest_lateral = std::max(largest_lateral, std::abs(yaw_rate) * here.speed_mps);
      if (here.speed_mps > 1.0) {
        const double course = std::atan2(velocity.y(), velocity.x());
        REQUIRE(std::abs(turned_rad(course, here.heading_rad)) < 0.03);
      }
    }
    CHECK(largest_lateral < 1.25 * style.lateral_acceleration_mps2);
    CHECK(largest_lateral > 0.5 * style.lateral_acceleration_mps2);
  }
}
