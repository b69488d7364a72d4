#include "ray_scene.h"

#include "small_city.h"

using namespace hqslam::sim;

TEST_CASE("a moving thing is met where it is at the ray's time") {
  City city = empty_city();  // a wall at 100 m and a cube of two metres
  add_wall(city.fixed, 100.0, -1.0, 1.0);
  add_box(city.prototypes.emplace_back(), Eigen::Isometry3d::Identity(), {-1.0, -1.0, -1.0},
          {1.0, 1.0, 1.0}, {Material::kCloth, 1});
  RayScene scene(city);
  ActorMotion actor;
  actor.T_world_at_start = Eigen::Translation3d(10.0, 0.0, 0.0);
  actor.T_world_at_end = Eigen::Translation3d(12.0, 0.0, 0.0);
  scene.place_actors({actor});
  for (const double fraction : {0.0, 0.25, 0.8}) {
    CHECK(scene.cast({0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, fraction, 200.0).value().range_m ==
          doctest::Approx(9.0 + 2.0 * fraction).epsilon(1e-6));
  }
  scene.place_actors({});
  const auto hit = scene.cast({0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, 0.5, 200.0).value();
  CHECK(hit.range_m == doctest::Approx(100.0).epsilon(1e-9));
}
