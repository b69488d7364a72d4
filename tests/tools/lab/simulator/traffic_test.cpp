#include "traffic.h"

#include <doctest/doctest.h>

#include <string>
#include <utility>

#include "city.h"
#include "hqslam/sim/drive.h"

using namespace hqslam::sim;

namespace {

/// Cars and walkers about the sensor in a minute of a drive, once a second, and where it is then.
std::pair<std::size_t, Eigen::Vector2d> actors_in_a_minute(const std::string& drive) {
  const DriveStyle style = drive_style(drive);
  const Layout layout = make_layout(style.city, 1);
  const DriverPath ego = plan_path(layout, style.driver, 1, 60.0);
  const Traffic traffic(layout, style, ego, 3, 60.0);
  std::size_t actors = 0;
  for (double time_s = 0.0; time_s < 60.0; time_s += 1.0) {
    actors += traffic.actors(time_s, time_s + 0.1, ego.at_time(time_s).plane_m).size();
  }
  return {actors, ego.at_time(60.0).plane_m};
}

}  // namespace

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

TEST_CASE("actors move by their speed between the start and the end of a scan") {
  const DriveStyle style = drive_style("hills");
  const Layout layout = make_layout(style.city, 1);
  const DriverPath ego = plan_path(layout, style.driver, 1, 60.0);
  const Traffic traffic(layout, style, ego, 3, 60.0);
  int cars = 0;
  int walkers = 0;
  for (double time_s = 0.0; time_s < 60.0; time_s += 1.0) {
    for (const ActorMotion& actor :
         traffic.actors(time_s, time_s + 0.1, ego.at_time(time_s).plane_m)) {
      const double moved_m =
          (actor.T_world_at_end.translation() - actor.T_world_at_start.translation()).norm();
      if (actor.prototype >= kFirstWalker) {
        ++walkers;
        CHECK(moved_m < 0.25);
        CHECK(moved_m > 0.02);
      } else {
        ++cars;
        CHECK(moved_m < 2.2);
      }
    }
  }
  CHECK(cars > 20);
  CHECK(walkers > 20);
}

TEST_CASE("at a busy hour the same way leads through three times as many actors or more") {
  for (const std::string drive : {"town", "hills"}) {
    const auto [usual, usual_end_m] = actors_in_a_minute(drive);
    const auto [busy, busy_end_m] = actors_in_a_minute(drive + "-busy");
    CHECK(busy > 3 * usual);
    CHECK(busy_end_m == usual_end_m);
  }
}
