#include "foreign_map/viewpoints.h"

#include <doctest/doctest.h>

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
