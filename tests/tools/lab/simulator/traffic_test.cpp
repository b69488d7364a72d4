#include "traffic.h"

#include "city.h"
#include "hqslam/sim/drive.h"
#include "testing.h"

using namespace hqslam::sim;

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
