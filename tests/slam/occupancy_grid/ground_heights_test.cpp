#include "occupancy_grid/ground_heights.h"

#include "testing.h"

using namespace hqslam::slam;

namespace {

/// Three points, as many as it takes, about a place.
void add_three(GroundHeights& ground, double x_m, double y_m, double z_m) {
  for (const double off_m : {-0.01, 0.0, 0.01}) ground.add({x_m, y_m, z_m + off_m});
}

}  // namespace

TEST_CASE("the ground is the mean of a cell's points, whatever their order") {
  GroundHeights ground;
  add_three(ground, 10.25, 4.25, -1.7);
  ground.settle();
  CHECK(*ground.at({10.1, 4.4}) == doctest::Approx(-1.7));
}

TEST_CASE("beside the ground it may rise by a quarter, and beyond 3 m nothing is known") {
  GroundHeights ground;
  add_three(ground, 0.25, 0.25, 0.0);
  ground.settle();
  CHECK(*ground.at({2.25, 0.25}) == doctest::Approx(0.5));
  CHECK(*ground.at({3.25, 0.25}) == doctest::Approx(0.75));
  CHECK_FALSE(ground.at({3.75, 0.25}));
  CHECK_FALSE(ground.at({1e30, 0.25}));
}

TEST_CASE("a flat roof is no ground where the street beside it is measured") {
  GroundHeights ground;
  for (int i = -8; i <= 8; ++i) {
    for (int k = -8; k <= 8; ++k) {
      const bool is_car = std::abs(i) <= 3 && std::abs(k) <= 1;
      add_three(ground, 0.5 * i + 0.25, 0.5 * k + 0.25, is_car ? 1.5 : 0.0);
    }
  }
  ground.settle();
  CHECK(*ground.at({0.25, 0.25}) <= 0.25);
  CHECK(*ground.at({3.25, 3.25}) == doctest::Approx(0.0));
}

TEST_CASE("two points make no ground") {
  GroundHeights ground;
  ground.add({0.25, 0.25, -3.0});
  ground.add({0.25, 0.25, -3.0});
  ground.settle();
  CHECK_FALSE(ground.at({0.25, 0.25}));
}
