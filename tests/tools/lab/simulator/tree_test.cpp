#include <doctest/doctest.h>

#include "prototype.h"
#include "random.h"
#include "ray_scene.h"
#include "small_city.h"

using namespace hqslam::sim;
using namespace hqslam::test;

TEST_CASE("crowns stop some rays and let others through") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    City city = empty_city();
    add_wall(city.fixed, 30.0, -100.0, 100.0);
    city.prototypes.push_back(make_tree(seed));
    city.placements.push_back({0, Eigen::Affine3d::Identity(), 128});
    const RayScene scene(city);
    double crown_m = 0.0;
    for (const Eigen::Vector3f& vertex : city.prototypes[0].vertices_m) {
      crown_m = std::max(crown_m, static_cast<double>(vertex.z()));
    }
    int through = 0;
    constexpr int kRays = 2000;
    Random random(seed);
    for (int ray = 0; ray < kRays; ++ray) {
      const Eigen::Vector3d origin(-20.0, random.uniform(-0.7, 0.7),
                                   0.62 * crown_m + random.uniform(-0.7, 0.7));
      const auto hit = scene.cast(origin, {1.0, 0.0, 0.0}, 0.0, 100.0);
      if (hit && hit->range_m > 45.0) ++through;
    }
    CHECK(through > 0.03 * kRays);
    CHECK(through < 0.75 * kRays);
  }
}
