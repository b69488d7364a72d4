#include "driver_path.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "hqslam/sim/drive.h"
#include "random.h"

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

/// Times at which the car comes within 5 m of where it was more than 30 s before, each 30 s apart.
int separate_revisits(const PlannedDrive& drive) {
  std::vector<PathState> past;
  int revisits = 0;
  double last_s = -100.0;
  for (double time_s = 0.0; time_s < drive.duration_s; time_s += 0.5) {
    past.push_back(drive.path.at_time(time_s));
    if (time_s - last_s < 30.0 || past.size() <= 61) continue;
    for (std::size_t k = 0; k + 61 < past.size(); ++k) {
      // Driven on since: standing at a crossing is no loop.
      if (past.back().along_m - past[k].along_m > 100.0 &&
          (past.back().plane_m - past[k].plane_m).norm() < 5.0) {
        ++revisits;
        last_s = time_s;
        break;
      }
    }
  }
  return revisits;
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

TEST_CASE("town keeps 15 m/s, stops and goes on, and loops at least three times") {
  const PlannedDrive town("town");
  CHECK(town.path.duration_s() > town.duration_s);
  double fastest_mps = 0.0;
  int stops = 0;
  bool standing = true;
  for (double time_s = 0.0; time_s < town.duration_s; time_s += 0.1) {
    const double speed_mps = town.path.at_time(time_s).speed_mps;
    fastest_mps = std::max(fastest_mps, speed_mps);
    if (speed_mps < 0.01 && !standing) ++stops;
    standing = speed_mps < 0.01;
  }
  CHECK(fastest_mps <= 15.0);
  CHECK(fastest_mps > 12.0);
  CHECK(stops >= 3);
  CHECK(separate_revisits(town) >= 3);
}

TEST_CASE("town drives some street again from its other end") {
  const PlannedDrive town("town");
  std::vector<PathState> past;
  for (double time_s = 0.0; time_s < town.duration_s; time_s += 0.5) {
    past.push_back(town.path.at_time(time_s));
  }
  bool met_reverse = false;
  for (std::size_t k = 0; k < past.size() && !met_reverse; ++k) {
    met_reverse = std::any_of(past.begin(), past.begin() + k, [&](const PathState& before) {
      return (before.plane_m - past[k].plane_m).norm() < 8.0 &&
             std::abs(turned_rad(before.heading_rad, past[k].heading_rad)) > 3.0;
    });
  }
  CHECK(met_reverse);
}

TEST_CASE("hills climbs steep streets and turns fast") {
  const PlannedDrive hills("hills");
  CHECK(hills.path.duration_s() > hills.duration_s);
  double steepest = 0.0;
  double fastest_turn = 0.0;
  PathState before = hills.path.at_time(0.0);
  for (double time_s = 0.1; time_s < hills.duration_s; time_s += 0.1) {
    const PathState here = hills.path.at_time(time_s);
    const Eigen::Vector2d forward(std::cos(here.heading_rad), std::sin(here.heading_rad));
    steepest = std::max(steepest, std::abs(hills.layout.terrain.slope(here.plane_m).dot(forward)));
    fastest_turn =
        std::max(fastest_turn, std::abs(turned_rad(before.heading_rad, here.heading_rad)) / 0.1);
    before = here;
  }
  CHECK(steepest > 0.10);
  CHECK(steepest < 0.25);
  CHECK(fastest_turn > 0.6);
  CHECK(separate_revisits(hills) >= 3);
}
