#include "on_ground.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace hqslam::sim;

TEST_CASE("what stands on the ground touches it ahead and to the left, whichever way it looks") {
  const Terrain terrain(7, 0.3);
  for (int k = 0; k < 12; ++k) {
    const Eigen::Vector2d at(40.0 * k - 200.0, 25.0 * k - 100.0);
    const Eigen::Isometry3d frame = on_ground(terrain, at, 0.5 * k);
    for (const Eigen::Vector3d& step :
         {Eigen::Vector3d(1.0, 0.0, 0.0), Eigen::Vector3d(0.0, 1.0, 0.0)}) {
      const Eigen::Vector3d point = frame * step;
      CHECK(std::abs(point.z() - terrain.height_m(point.head<2>())) < 0.03);
    }
    const Eigen::Vector3d forward = frame.linear().col(0);
    CHECK(std::remainder(std::atan2(forward.y(), forward.x()) - 0.5 * k, 2.0 * std::numbers::pi) ==
          doctest::Approx(0.0));
  }
}
