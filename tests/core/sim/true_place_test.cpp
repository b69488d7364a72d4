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

TEST_CASE("below a surface that is all but upright the ground is found, too") {
  City city = street();
  // It leans by 3 mm a metre, so that Embree's rays, rounded to single precision, meet it
  // centimetres from where those in double precision do.
  add_quad(city.fixed, {400.0, -9.0, 1.0}, {400.0, 9.0, 1.0}, {400.012, 9.0, 5.0},
           {400.012, -9.0, 5.0}, {Material::kPlaster, 1});
  add_quad(city.fixed, {390.0, -9.0, 1.0}, {410.0, -9.0, 1.0}, {410.0, 9.0, 1.0}, {390.0, 9.0, 1.0},
           {Material::kConcrete, 1});
  const RayScene scene(city);
  for (int i = 1; i < 100; ++i) {
    const auto place = true_place(scene, {400.0 + 1.2e-4 * i, 0.3, 3.0}, {0.05, 0.25, 2.0});
    REQUIRE(place);
    CHECK(place->ground_m == doctest::Approx(1.0));
    CHECK(place->is_occupied);
  }
}
