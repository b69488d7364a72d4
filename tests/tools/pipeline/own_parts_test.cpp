#include "hqslam/pipeline/own_parts.h"

namespace hqslam::pipeline {
namespace {

const SensorModel kCarried = sensor_preset("os1-16");

/// Scan i of the surroundings, range_m(i, row, column).
OrganizedCloud scan_of(const std::function<double(int, int, int)>& range_m, int i) {
  OrganizedCloud cloud(kCarried.rows(), kCarried.columns);
  for (int row = 0; row < cloud.rows; ++row) {
    for (int column = 0; column < cloud.columns; ++column) {
      const std::size_t pixel = cloud.index(row, column);
      cloud.range_m[pixel] = static_cast<float>(range_m(i, row, column));
      cloud.points_m[pixel].x() = cloud.range_m[pixel];
    }
  }
  return cloud;
}

/// A room whose walls come nearer by 0.2 m a scan, as to a sensor that moves.
double moving_room(int i, int, int) { return 20.0 - 0.2 * i; }

bool is_rack(int row, int column) { return row > 9 && column > 99 && column < 150; }

/// A roof rack, which shakes by a few centimetres, in that room or in a standing one.
double with_rack(int i, int row, int column) {
  return is_rack(row, column) ? 1.2 + 0.03 * std::sin(i) : moving_room(i, row, column);
}
double with_rack_standing(int, int row, int column) { return with_rack(0, row, column); }

/// The returns of the last of `scans` scans that are left out.
auto left_out(OwnParts& parts, const std::function<double(int, int, int)>& range_m, int scans) {
  OrganizedCloud scan;
  for (int i = 0; i < scans; ++i) scan = parts.without(scan_of(range_m, i));
  return std::ranges::count(scan.range_m, 0.0F);
}

}  // namespace

TEST_CASE("what keeps its range while the sensor moves and ends there is a part of the vehicle") {
  OwnParts parts(kCarried);
  CHECK(left_out(parts, with_rack, 25) == 0);
  CHECK(parts.text().empty());
  CHECK(left_out(parts, with_rack, 40) == 6 * 50);
  CHECK(parts.text() == "300 of 16384 pixels, 1.2 to 1.2 m away");
  const OrganizedCloud scan = parts.without(scan_of(with_rack, 41));
  CHECK(scan.range_m[scan.index(10, 100)] == 0.0F);
  CHECK(scan.points_m[scan.index(10, 100)].isZero());
  CHECK(scan.range_m[scan.index(9, 100)] == doctest::Approx(moving_room(41, 9, 100)));
}

TEST_CASE("an edge of a part from which few echoes return does not delay it") {
  const auto with_edge = [](int i, int row, int column) {
    if (row == 9 && is_rack(10, column)) return (i + column) % 3 == 0 ? 1.2 : 0.0;
    return with_rack(i, row, column);
  };
  OwnParts parts(kCarried);
  left_out(parts, with_edge, 40);
  CHECK(parts.text() == "300 of 16384 pixels, 1.2 to 1.2 m away");
}

TEST_CASE("what is near a sensor that stands is seen") {
  OwnParts parts(kCarried);
  CHECK(left_out(parts, with_rack_standing, 60) == 0);
}

TEST_CASE("without anything farther away nobody knows whether the sensor moves") {
  OwnParts parts(kCarried);
  const auto box = [](int i, int row, int column) {
    return is_rack(row, column) ? 1.2 : 2.9 - 0.02 * i;
  };
  CHECK(left_out(parts, box, 60) == 0);
}

TEST_CASE("a wall and a floor along the way are seen, though they keep their range beside it") {
  // Where the wall is far away a turn by a degree changes its range.
  const auto wall = [](int i, int, int column) {
    const double azimuth_rad =
        std::numbers::pi - (column + 0.5) * kCarried.column_step_rad() + 0.01 * std::sin(1.3 * i);
    return std::sin(azimuth_rad) > 0.1 ? 1.0 / std::sin(azimuth_rad) : moving_room(i, 0, column);
  };
  OwnParts beside_wall(kCarried);
  CHECK(left_out(beside_wall, wall, 60) == 0);
  const auto floor = [](int i, int row, int column) {
    const double depression_rad = -kCarried.beam_elevation_rad[row] + 0.003 * std::sin(1.3 * i);
    return depression_rad > 0.05 ? 0.4 / std::sin(depression_rad) : moving_room(i, row, column);
  };
  OwnParts above_floor(kCarried);
  CHECK(left_out(above_floor, floor, 60) == 0);
}

TEST_CASE("a part that is hidden for a moment remains one, and one that is taken off does not") {
  OwnParts parts(kCarried);
  REQUIRE(left_out(parts, with_rack, 40) == 300);
  CHECK(left_out(parts, moving_room, 5) == 0);
  CHECK(left_out(parts, with_rack, 1) == 300);
  CHECK(left_out(parts, moving_room, 15) == 0);
  CHECK(left_out(parts, with_rack, 1) == 0);
}

TEST_CASE("scans of another sensor are refused") {
  OwnParts parts(kCarried);
  CHECK_THROWS_WITH_AS(parts.without(OrganizedCloud(16, 512)),
                       "own parts: scan is 16x512, expected 16x1024", Error);
}

}  // namespace hqslam::pipeline
