#include "map/map_matching.h"

#include "testing.h"

using hqslam::slam::Neighbours;

namespace {

Neighbours five(const std::array<Eigen::Vector3f, 5>& points_m) { return {5, points_m, {}}; }

}  // namespace

TEST_CASE("five points along a pole give the pole") {
  const auto line = hqslam::slam::fit_line(
      five({{{3, 4, 0}, {3.01F, 4, 0.3F}, {3, 4.01F, 0.6F}, {2.99F, 4, 0.9F}, {3, 3.99F, 1.2F}}}));
  REQUIRE(line);
  CHECK(std::abs(line->direction.z()) > 0.999);
  CHECK((line->point_m - Eigen::Vector3d(3, 4, 0.6)).norm() < 1e-6);
}

TEST_CASE("five points of a patch are no line, along a ring no plane, and fewer neither") {
  CHECK(!hqslam::slam::fit_line(
      five({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.5F, 0.5F, 0}}})));
  CHECK(!hqslam::slam::fit_plane(
      five({{{0, 0, 0}, {0.4F, 0, 0.01F}, {0.8F, 0.01F, 0}, {1.2F, 0, 0}, {1.6F, 0, 0.01F}}}),
      0.2));
  Neighbours few = five({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}}});
  few.count = 4;
  CHECK(!hqslam::slam::fit_line(few));
  CHECK(!hqslam::slam::fit_plane(few, 10.0));
  CHECK(!hqslam::slam::fit_surface(few, 10.0));
}

TEST_CASE("neighbours on a surface make a plane, those of one row a line") {
  using namespace hqslam::slam;
  const auto patch =
      fit_surface(five({{{0, 0, 2}, {1, 0, 2}, {0, 1, 2}, {1, 1, 2}, {2, 1, 2}}}), 0.2);
  REQUIRE(patch);
  REQUIRE(std::holds_alternative<MapPlane>(*patch));
  CHECK(std::abs(std::get<MapPlane>(*patch).normal.z()) == doctest::Approx(1.0));
  const auto row =
      fit_surface(five({{{0, 5, 0}, {0.4F, 5, 0}, {0.8F, 5, 0}, {1.2F, 5, 0}, {1.6F, 5, 0}}}), 0.2);
  REQUIRE(row);
  REQUIRE(std::holds_alternative<MapLine>(*row));
  CHECK(std::abs(std::get<MapLine>(*row).direction.x()) == doctest::Approx(1.0));
  CHECK(!fit_surface(five({{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {2, 2, 0}, {1, 1, 0.9F}}}), 0.2));
}

TEST_CASE("a point too far off spoils a plane; a plane may go through the map's origin") {
  const auto points = five({{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {2, 2, 0}, {1, 1, 0.9F}}});
  CHECK(!hqslam::slam::fit_plane(points, 0.2));
  CHECK(hqslam::slam::fit_plane(points, 0.8));
  const auto through_origin = hqslam::slam::fit_plane(
      five({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {-1, 0.5F, 0}}}), 0.2);
  REQUIRE(through_origin);
  CHECK(std::abs(through_origin->normal.z()) == doctest::Approx(1.0));
}
