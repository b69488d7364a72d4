#include "foreign_map/surfels.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace hqslam;

TEST_CASE("a plane's points become discs that touch, and lonely points nothing") {
  std::vector<Eigen::Vector3f> points_m = {{50.0F, 0.0F, 0.0F}, {0.0F, 0.0F, 30.0F}};
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 20; ++j) {
      // Two in each voxel, whose mean is the voxel's middle.
      for (const float aside_m : {-0.02F, 0.02F}) {
        const Eigen::Vector2f at_m(0.1F * static_cast<float>(i) + 0.05F + aside_m,
                                   0.1F * static_cast<float>(j) + 0.05F);
        points_m.emplace_back(at_m.x(), at_m.y(), 0.04F + 0.1F * at_m.x());
      }
    }
  }
  const auto surfels = slam::surfels_of(points_m, 0.1);
  CHECK(surfels.size() >= 400);  // some voxels are cut by the slope
  CHECK(surfels.size() < 480);
  const Eigen::Vector3f normal = Eigen::Vector3f(-0.1F, 0.0F, 1.0F).normalized();
  for (const slam::Surfel& surfel : surfels) {
    CHECK(std::abs(surfel.normal.dot(normal)) > 0.999F);
    CHECK(surfel.radius_m > 0.05F);
    CHECK(surfel.radius_m < 0.2F);
  }
}

TEST_CASE("tiles give all surfels within reach, and not those far beyond") {
  std::vector<slam::Surfel> surfels;
  for (int i = -100; i <= 100; ++i) {
    surfels.push_back({{static_cast<float>(i), -3.0F, 0.0F}, Eigen::Vector3f::UnitZ(), 0.1F});
  }
  int within = 0;
  int farthest = 0;
  slam::SurfelTiles(surfels).for_each_near({-10.0, 0.0, 1.7}, 30.0, [&](const slam::Surfel& s) {
    const int distance = std::abs(static_cast<int>(s.point_m.x()) + 10);
    within += distance <= 29 ? 1 : 0;
    farthest = std::max(farthest, distance);
  });
  CHECK(within == 59);
  CHECK(farthest <= 46);
}
