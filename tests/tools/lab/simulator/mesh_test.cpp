#include "mesh.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "small_city.h"

using namespace hqslam::sim;
using namespace hqslam::test;

TEST_CASE("every triangle has a surface and vertices that exist") {
  TriangleMesh mesh;
  add_box(mesh, upright_frame({1.0, 2.0, 3.0}, 0.5), {-1.0, -2.0, 0.0}, {1.0, 2.0, 3.0}, {});
  add_column(mesh, {0.0, 0.0, 0.0}, {1.0, 0.0, 2.0}, 0.3, 0.0, 7, {});
  add_grid(mesh, std::vector<Eigen::Vector3d>(12, Eigen::Vector3d::Zero()), 3, 4, {});
  CHECK(mesh.triangles.size() == 12 + 14 + 12);
  CHECK(mesh.surfaces.size() == mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t index : triangle) CHECK(index < mesh.vertices_m.size());
  }
}

TEST_CASE("the faces of a box have the area of a box") {
  TriangleMesh mesh;
  add_box(mesh, upright_frame({5.0, -2.0, 1.0}, 1.1), {0.0, 0.0, 0.0}, {2.0, 3.0, 4.0}, {});
  double area_m2 = 0.0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3f ab = mesh.vertices_m[t[1]] - mesh.vertices_m[t[0]];
    const Eigen::Vector3f ac = mesh.vertices_m[t[2]] - mesh.vertices_m[t[0]];
    area_m2 += 0.5 * static_cast<double>(ab.cross(ac).norm());
  }
  CHECK(area_m2 == doctest::Approx(2.0 * (6.0 + 8.0 + 12.0)).epsilon(1e-5));
}

TEST_CASE("a column keeps its radii") {
  TriangleMesh mesh;
  const Eigen::Vector3d from(1.0, 1.0, 0.0);
  const Eigen::Vector3d to(1.0, 1.0, 5.0);
  add_column(mesh, from, to, 0.5, 0.2, 8, {});
  for (const Eigen::Vector3f& vertex : mesh.vertices_m) {
    const bool top = vertex.z() > 2.5F;
    const double radius_m = (vertex.cast<double>() - (top ? to : from)).norm();
    CHECK(radius_m == doctest::Approx(top ? 0.2 : 0.5).epsilon(1e-5));
  }
}

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
