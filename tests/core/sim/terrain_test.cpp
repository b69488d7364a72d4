#include "terrain.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "random.h"

using namespace hqslam::sim;

TEST_CASE("the slope of the terrain is the derivative of its height and keeps the bound") {
  const Terrain terrain(3, 0.2);
  Random random(1);
  constexpr double kStep_m = 1e-3;
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector2d at(random.uniform(-800.0, 800.0), random.uniform(-800.0, 800.0));
    const Eigen::Vector2d slope = terrain.slope(at);
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d step = kStep_m * Eigen::Vector2d::Unit(axis);
      const double numeric =
          (terrain.height_m(at + step) - terrain.height_m(at - step)) / (2.0 * kStep_m);
      CHECK(std::abs(slope[axis] - numeric) < 1e-7);
    }
    CHECK(slope.norm() <= 0.2);
  }
}

TEST_CASE("what stands on the ground touches it ahead and to the left, whichever way it looks") {
  const Terrain terrain(7, 0.3);
  for (int k = 0; k < 12; ++k) {
    const Eigen::Vector2d at(40.0 * k - 200.0, 25.0 * k - 100.0);
    const Eigen::Isometry3d frame = terrain.frame(at, 0.5 * k);
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
