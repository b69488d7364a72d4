#include "true_place.h"

#include <doctest/doctest.h>

#include "small_city.h"

using namespace hqslam::sim;
using namespace hqslam::test;

namespace {

/// A street at z = 1, on it a box like a car's body, above it a roof 4 m up.
City street() {
  City city = empty_city();
  const Surface surface{Material::kConcrete, 1};
  add_quad(city.fixed, {-9.0, -9.0, 1.0}, {9.0, -9.0, 1.0}, {9.0, 9.0, 1.0}, {-9.0, 9.0, 1.0},
           surface);
  add_box(city.fixed, Eigen::Isometry3d::Identity(), {2.0, -1.0, 1.2}, {6.0, 1.0, 2.5}, surface);
  add_quad(city.fixed, {-9.0, 5.0, 5.0}, {9.0, 5.0, 5.0}, {9.0, 9.0, 5.0}, {-9.0, 9.0, 5.0},
           surface);
  return city;
}

}  // namespace

TEST_CASE("a place is occupied under a bonnet and at its edge, free beside it and below a roof") {
  const City city = street();
  const RayScene scene(city);
  const UprightColumn column{0.05, 0.25, 2.0};
  const auto at = [&](double x_m, double y_m) {
    const auto place = true_place(scene, {x_m, y_m, 3.0}, column);
    REQUIRE(place);
    CHECK(place->ground_m == doctest::Approx(1.0));
    return place->is_occupied;
  };
  CHECK(at(4.0, 0.0));
  CHECK(at(1.96, 0.5));
  CHECK_FALSE(at(1.94, 0.5));
  CHECK_FALSE(at(0.0, 7.0));
  CHECK_FALSE(true_place(scene, {20.0, 0.0, 3.0}, column));
}
