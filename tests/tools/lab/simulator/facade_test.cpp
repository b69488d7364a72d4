#include <doctest/doctest.h>

#include "block_contents.h"
#include "ray_scene.h"
#include "small_city.h"

using namespace hqslam::sim;
using namespace hqslam::test;

namespace {

/// Rays of a raster by what they meet of a wall in the plane x = 10.
struct Seen {
  int wall = 0, glass = 0, door = 0, in_front = 0, behind = 0;
};

Seen look_at_facade(const FacadeStyle& style) {
  City city = empty_city();
  Random random(2);
  // Seen from -x the wall's left end is at +y.
  add_facade(city.fixed, {{10.0, 6.0}, {10.0, -6.0}, -1.0, 0.0}, style, true, random);
  const RayScene scene(city);
  Seen seen;
  for (double y_m = -5.9; y_m < 5.9; y_m += 0.093) {
    for (double z_m = 0.4; z_m < 8.5; z_m += 0.077) {
      const auto hit = scene.cast({0.0, y_m, z_m}, {1.0, 0.0, 0.0}, 0.0, 50.0);
      if (!hit) {
        ++seen.behind;
      } else if (hit->surface.material == Material::kGlass && hit->range_m > 10.0) {
        ++seen.glass;
        CHECK(hit->range_m == doctest::Approx(10.0 + style.recess_m).epsilon(1e-4));
      } else if (hit->surface.material == Material::kWood && hit->range_m > 10.2) {
        ++seen.door;
      } else if (hit->range_m < 9.99) {
        ++seen.in_front;
      } else {
        ++seen.wall;
        CHECK(hit->range_m < 10.0 + style.recess_m + 1e-3);
      }
    }
  }
  return seen;
}

}  // namespace

TEST_CASE("a facade is closed, with recessed windows, a door and balconies in front of it") {
  FacadeStyle style;
  style.wall = {Material::kPlaster, 100};
  style.balcony_share = 1.0;
  const Seen seen = look_at_facade(style);
  CHECK(seen.behind == 0);
  CHECK(seen.glass > 500);
  CHECK(seen.door > 50);
  CHECK(seen.in_front > 500);
  CHECK(seen.wall > 2000);
}
