#include "terrain.h"

#include <doctest/doctest.h>

#include <cmath>

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
