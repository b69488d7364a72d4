#include "ray_scene.h"

#include "small_city.h"
#include "testing.h"

using namespace hqslam::sim;
using namespace hqslam::test;

namespace {

/// A wall at 100 m and a cube of two metres that may be placed before it.
City city_with_cube(Material material) {
  City city = empty_city();
  add_wall(city.fixed, 100.0, -1.0, 1.0);
  add_box(city.prototypes.emplace_back(), Eigen::Isometry3d::Identity(), {-1.0, -1.0, -1.0},
          {1.0, 1.0, 1.0}, {material, 1});
  return city;
}

}  // namespace

TEST_CASE("a ray against a wall: range, incidence and surface by hand") {
  City city = empty_city();
  add_wall(city.fixed, 10.0, -50.0, 50.0, 77);
  const RayScene scene(city);
  const Eigen::Vector3d direction = Eigen::Vector3d(1.0, 1.0, 0.0).normalized();
  const auto hit = scene.cast({4.0, 0.0, 1.0}, direction, 0.0, 100.0);
  REQUIRE(hit);
  CHECK(hit->range_m == doctest::Approx(6.0 * std::sqrt(2.0)).epsilon(1e-9));
  CHECK(hit->cos_incidence == doctest::Approx(std::sqrt(0.5)).epsilon(1e-9));
  CHECK(hit->surface.material == Material::kPlaster);
  CHECK(hit->surface.shade == 77);
  CHECK_FALSE(scene.cast({4.0, 0.0, 1.0}, direction, 0.0, 8.0));
  CHECK_FALSE(scene.cast({4.0, 0.0, 1.0}, -direction, 0.0, 100.0));
}

TEST_CASE("placed things are met where they were put, in their size") {
  City city = city_with_cube(Material::kCarPaint);
  city.placements.push_back({0, Eigen::Translation3d(20.0, 0.0, 0.0) * Eigen::Scaling(2.0), 222});
  const RayScene scene(city);
  const auto hit = scene.cast({0.0, 0.0, 0.5}, {1.0, 0.0, 0.0}, 0.0, 200.0);
  REQUIRE(hit);
  CHECK(hit->range_m == doctest::Approx(18.0).epsilon(1e-9));
  CHECK(hit->surface.shade == 222);
}

TEST_CASE("a moving thing is met where it is at the ray's time") {
  const City city = city_with_cube(Material::kCloth);
  RayScene scene(city);
  ActorMotion actor;
  actor.T_world_at_start = Eigen::Translation3d(10.0, 0.0, 0.0);
  actor.T_world_at_end = Eigen::Translation3d(12.0, 0.0, 0.0);
  scene.place_actors({actor});
  for (const double fraction : {0.0, 0.25, 0.8}) {
    const auto hit = scene.cast({0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, fraction, 200.0);
    REQUIRE(hit);
    CHECK(hit->range_m == doctest::Approx(9.0 + 2.0 * fraction).epsilon(1e-6));
  }
  scene.place_actors({});
  const auto hit = scene.cast({0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, 0.5, 200.0);
  REQUIRE(hit);
  CHECK(hit->range_m == doctest::Approx(100.0).epsilon(1e-9));
}
