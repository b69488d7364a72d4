#include "foreign_map/surfels.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace hqslam;

namespace {

/// A level square, from a corner on, a surfel every 0.25 m.
void add_square(std::vector<slam::Surfel>& surfels, double x_m, double y_m, double side_m,
                double z_m) {
  for (double x = x_m + 0.125; x < x_m + side_m; x += 0.25) {
    for (double y = y_m + 0.125; y < y_m + side_m; y += 0.25) {
      surfels.push_back({Eigen::Vector3d(x, y, z_m).cast<float>(), Eigen::Vector3f::UnitZ(), 0.2F});
    }
  }
}

}  // namespace

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

TEST_CASE("places are on wide ground, clear above, every four metres; not on small roofs") {
  std::vector<slam::Surfel> surfels;
  add_square(surfels, -20.0, -20.0, 40.0, -1.0);
  add_square(surfels, -1.0, -1.0, 2.0, 0.2);    // a table over the middle
  add_square(surfels, 4.0, 4.0, 2.0, 4.0);      // high above: no matter
  add_square(surfels, 100.0, 100.0, 6.0, 8.0);  // a roof of 36 square metres
  const std::vector<Pose> places = slam::viewpoints_in(surfels);
  CHECK(places.size() == 10 * 10 - 1);
  for (const Pose& place : places) {
    const Eigen::Vector3d at_m = place.translation();
    CHECK(at_m.z() == doctest::Approx(0.7));
    CHECK(at_m.head<2>().cwiseAbs().maxCoeff() < 20.0);
    CHECK(at_m.head<2>().cwiseAbs().minCoeff() >= 0.0);
    CHECK((at_m - Eigen::Vector3d(0.5, 0.5, 0.7)).norm() > 1.0);
    CHECK(place.linear().isIdentity());
  }
}

TEST_CASE("a step parts the ground, and what is too small by itself is no place") {
  std::vector<slam::Surfel> surfels;
  add_square(surfels, 0.0, 0.0, 10.0, 0.0);
  add_square(surfels, 10.0, 0.0, 6.0, 0.5);
  for (const Pose& place : slam::viewpoints_in(surfels)) CHECK(place.translation().x() < 10.0);
  CHECK(slam::viewpoints_in({}).empty());
}
