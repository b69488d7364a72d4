#include "true_surface.h"

#include "echo.h"
#include "small_city.h"

using namespace hqslam::sim;

namespace {

/// Boxes at random places, some of them placed copies of one shape in other sizes and turns.
City random_city() {
  City city = empty_city();
  Random random(3);
  const auto place = [&] { return random_point(random, {10.0, 10.0, 2.0}); };
  TriangleMesh box;
  add_box(box, Eigen::Isometry3d::Identity(), {-0.5, -0.3, -0.2}, {0.5, 0.3, 0.2},
          {Material::kConcrete, 1});
  city.prototypes.push_back(box);
  for (int k = 0; k < 30; ++k) {
    const Eigen::Vector3d origin_m = place();
    const Eigen::Vector3d axis = place().normalized();
    const Eigen::Isometry3d turned =
        Eigen::Translation3d(origin_m) * Eigen::AngleAxisd(random.uniform(0.0, 3.0), axis);
    if (k % 2 == 0) {
      add_box(city.fixed, turned, {-0.5, -0.3, -0.2}, {0.5, 0.3, 0.2}, {Material::kConcrete, 1});
    } else {
      const double scale = random.uniform(0.5, 3.0);
      city.placements.push_back({0, Eigen::Affine3d(turned) * Eigen::Scaling(scale), 1});
    }
  }
  return city;
}

/// The same by looking at every triangle of the city, moved to where it is placed.
double distance_by_all_triangles_m(const City& city, const Eigen::Vector3d& point_m) {
  double nearest_m = std::numeric_limits<double>::infinity();
  const auto look_at = [&](const TriangleMesh& mesh, const Eigen::Affine3d& T_world_mesh) {
    for (const auto& triangle : mesh.triangles) {
      const auto corner = [&](int k) {
        return Eigen::Vector3d(T_world_mesh * mesh.vertices_m[triangle[k]].cast<double>());
      };
      nearest_m =
          std::min(nearest_m, distance_to_triangle_m(point_m, corner(0), corner(1), corner(2)));
    }
  };
  look_at(city.fixed, Eigen::Affine3d::Identity());
  for (const Placement& placement : city.placements) {
    look_at(city.prototypes[placement.prototype], placement.T_world_prototype);
  }
  return nearest_m;
}

}  // namespace

TEST_CASE("the nearest surface is that of a search through all triangles, placed ones too") {
  const City city = random_city();
  const RayScene scene(city);
  Random random(5);
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::Vector3d point_m = random_point(random, {12.0, 12.0, 4.0});
    const double expected_m = distance_by_all_triangles_m(city, point_m);
    const auto found_m = scene.distance_m(point_m, 2.0);
    REQUIRE(found_m.has_value() == (expected_m < 2.0));
    if (found_m) REQUIRE(*found_m == doctest::Approx(expected_m).epsilon(1e-5));
  }
}

TEST_CASE("what a window shows is true where it is seen to be, and nowhere else") {
  for (const std::uint8_t shade : {std::uint8_t{1}, std::uint8_t{77}, std::uint8_t{200}}) {
    CAPTURE(shade);
    City city = empty_city();  // a window in the plane x = 10 whose shade decides what it shows
    add_quad(city.fixed, {10.0, -2.0, -2.0}, {10.0, 2.0, -2.0}, {10.0, 2.0, 2.0}, {10.0, -2.0, 2.0},
             {Material::kGlass, shade});
    const RayScene scene(city);
    const Eigen::Vector3d eye(0.0, 1.0, 0.0);
    const Eigen::Vector3d direction = Eigen::Vector3d(10.0, -1.0, 0.5).normalized();
    const auto hit = scene.cast(eye, direction, 0.0, 100.0).value();
    const double range_m = range_through_glass_m(hit);
    CHECK(range_m > hit.range_m + 0.1);
    const auto distance_m = [&](const Eigen::Vector3d& point_m) {
      return distance_to_true_surface_m(scene, {eye}, point_m, 1.0);
    };
    CHECK(distance_m(eye + range_m * direction) < 1e-3);
    CHECK(distance_m(eye + (range_m + 0.25) * direction) <= 0.2501);
    CHECK(distance_m(eye + (range_m + 0.25) * direction) > 0.1);
    CHECK(distance_m(eye + hit.range_m * direction) < 1e-3);  // the pane itself
    // In front of the window there is nothing, and beside it nothing to see through.
    CHECK(std::isinf(distance_m({5.0, 0.0, 0.0})));
    CHECK(std::isinf(distance_m({range_m, 9.0, 0.0})));
    // From nowhere, only the pane is there.
    const double behind_m = scene.distance_m(eye + range_m * direction, 50.0).value();
    CHECK(distance_to_true_surface_m(scene, {}, eye + range_m * direction, 50.0) == behind_m);
  }
}

TEST_CASE("the distance to a triangle by hand: face, edge, corner, and one without an area") {
  const Eigen::Vector3d a(0.0, 0.0, 0.0);
  const Eigen::Vector3d b(4.0, 0.0, 0.0);
  const Eigen::Vector3d c(0.0, 4.0, 0.0);
  CHECK(distance_to_triangle_m({1.0, 1.0, 2.0}, a, b, c) == doctest::Approx(2.0));
  CHECK(distance_to_triangle_m({1.0, 1.0, -0.5}, c, b, a) == doctest::Approx(0.5));
  CHECK(distance_to_triangle_m({2.0, -3.0, 4.0}, a, b, c) == doctest::Approx(5.0));
  CHECK(distance_to_triangle_m({-3.0, -4.0, 0.0}, a, b, c) == doctest::Approx(5.0));
  CHECK(distance_to_triangle_m({4.0, 4.0, 0.0}, a, b, c) == doctest::Approx(std::sqrt(8.0)));
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
