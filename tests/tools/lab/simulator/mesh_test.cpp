#include "mesh.h"

#include "small_city.h"
#include "testing.h"

using namespace hqslam::sim;
using namespace hqslam::test;

TEST_CASE("the distance to a triangle by hand: face, edge, corner") {
  const Eigen::Vector3d a(0.0, 0.0, 0.0);
  const Eigen::Vector3d b(4.0, 0.0, 0.0);
  const Eigen::Vector3d c(0.0, 4.0, 0.0);
  CHECK(distance_to_triangle_m({1.0, 1.0, 2.0}, a, b, c) == doctest::Approx(2.0));
  CHECK(distance_to_triangle_m({1.0, 1.0, -0.5}, c, b, a) == doctest::Approx(0.5));
  CHECK(distance_to_triangle_m({2.0, -3.0, 4.0}, a, b, c) == doctest::Approx(5.0));
  CHECK(distance_to_triangle_m({-3.0, -4.0, 0.0}, a, b, c) == doctest::Approx(5.0));
  CHECK(distance_to_triangle_m({4.0, 4.0, 0.0}, a, b, c) == doctest::Approx(std::sqrt(8.0)));
}

TEST_CASE("a triangle without an area is a line or a point") {
  const Eigen::Vector3d a(0.0, 0.0, 0.0);
  const Eigen::Vector3d b(2.0, 0.0, 0.0);
  CHECK(distance_to_triangle_m({1.0, 3.0, 0.0}, a, b, b) == doctest::Approx(3.0));
  CHECK(distance_to_triangle_m({0.0, 3.0, 4.0}, a, a, a) == doctest::Approx(5.0));
}

TEST_CASE("no point of the triangle is nearer, and one is as near") {
  Random random(7);
  const auto point = [&] { return random_point(random, {2.0, 2.0, 2.0}); };
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Vector3d a = point();
    const Eigen::Vector3d b = point();
    const Eigen::Vector3d c = point();
    const Eigen::Vector3d query = point();
    const double distance_m = distance_to_triangle_m(query, a, b, c);
    double sampled_m = 1e9;
    constexpr int kSteps = 200;
    for (int i = 0; i <= kSteps; ++i) {
      for (int k = 0; k + i <= kSteps; ++k) {
        const double u = static_cast<double>(i) / kSteps;
        const double v = static_cast<double>(k) / kSteps;
        sampled_m = std::min(sampled_m, (query - (a + u * (b - a) + v * (c - a))).norm());
      }
    }
    CHECK(distance_m <= sampled_m + 1e-12);
    CHECK(distance_m >= sampled_m - 0.04);
  }
}
