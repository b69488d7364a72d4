#include "hqslam/nn/interpolation.h"

#include "testing.h"

namespace hqslam::nn {
namespace {

/// One column.
RangeImage column(const std::vector<float>& ranges_m) {
  RangeImage image(static_cast<int>(ranges_m.size()), 1);
  image.range_m = ranges_m;
  return image;
}

using Ranges = std::vector<float>;

/// `rows` beams, half a degree apart.
std::vector<double> even_beams(int rows) {
  std::vector<double> elevation_rad;
  for (int row = 0; row < rows; ++row) elevation_rad.push_back(0.1 - 0.5 * row / 57.3);
  return elevation_rad;
}

Ranges filled(const Ranges& measured_m, RowSelection rows, int all, Interpolation interpolation) {
  return interpolate_rows(column(measured_m), rows, even_beams(all), interpolation).range_m;
}

}  // namespace

TEST_CASE("between 4 m and 12 m the three interpolations are what a hand computes") {
  const RowSelection rows{1, 4};
  CHECK(filled({4, 12}, rows, 7, Interpolation::kNearest) == Ranges{4, 4, 4, 12, 12, 12, 12});
  CHECK(filled({4, 12}, rows, 7, Interpolation::kLinear) == Ranges{4, 4, 6, 8, 10, 12, 12});
  const Ranges inverse = filled({4, 12}, rows, 7, Interpolation::kInverse);
  CHECK(inverse[2] == doctest::Approx(1.0 / (0.75 / 4 + 0.25 / 12)));
  CHECK(inverse[3] == doctest::Approx(6.0));
  CHECK(inverse[4] == doctest::Approx(1.0 / (0.25 / 4 + 0.75 / 12)));
  CHECK(inverse[1] == 4.0F);
  CHECK(inverse[5] == 12.0F);
}

TEST_CASE("where one of two rows is empty the nearer decides; rows outside repeat the outermost") {
  for (const Interpolation any :
       {Interpolation::kNearest, Interpolation::kLinear, Interpolation::kInverse}) {
    CHECK(filled({8, 0}, {0, 4}, 5, any) == Ranges{8, 8, 0, 0, 0});
    CHECK(filled({0, 8}, {0, 4}, 5, any) == Ranges{0, 0, 8, 8, 8});
    CHECK(filled({0, 0}, {0, 4}, 5, any) == Ranges{0, 0, 0, 0, 0});
    CHECK(filled({8, 0}, {0, 3}, 4, any) == Ranges{8, 8, 0, 0});
    CHECK(filled({3, 5}, {3, 1}, 5, any) == Ranges{3, 3, 3, 3, 5});
    CHECK(filled({3}, {0, 4}, 4, any) == Ranges{3, 3, 3, 3});
    CHECK(filled({3, 5, 4}, {0, 1}, 3, any) == Ranges{3, 5, 4});
  }
}

TEST_CASE("inverse interpolation follows the elevations of the beams, the others count rows") {
  // A wall 10 m away, and beams whose steps grow from a fifth of a degree to two degrees.
  const std::vector<double> elevation_rad = {0.050, 0.0465, 0.040, 0.028, 0.0};
  Ranges measured;
  for (const int row : {0, 4}) {
    measured.push_back(static_cast<float>(10.0 / std::cos(elevation_rad[row] - 0.3)));
  }
  const auto filled_with = [&](Interpolation interpolation) {
    return interpolate_rows(column(measured), {0, 4}, elevation_rad, interpolation).range_m;
  };
  const Ranges inverse = filled_with(Interpolation::kInverse);
  const Ranges linear = filled_with(Interpolation::kLinear);
  for (int row = 1; row < 4; ++row) {
    const double true_m = 10.0 / std::cos(elevation_rad[row] - 0.3);
    CHECK(inverse[row] == doctest::Approx(true_m).epsilon(5e-4));
    CHECK(std::fabs(linear[row] - true_m) > 3.0 * std::fabs(inverse[row] - true_m));
  }
  CHECK(rows_between(1, {0, 4}, elevation_rad).part_down == doctest::Approx(0.07));
  CHECK(rows_between(4, {0, 4}, elevation_rad).above == 1);
}

TEST_CASE("a row is between the nearest measured rows above and below, or is one itself") {
  std::vector<int> above;
  std::vector<int> below;
  for (int row = 0; row < 9; ++row) {  // measured: rows 1, 4, 7
    const RowsBetween between = rows_between(row, {1, 3}, 3);
    above.push_back(between.above);
    below.push_back(between.below);
  }
  CHECK(above == std::vector<int>{0, 0, 0, 0, 1, 1, 1, 2, 2});
  CHECK(below == std::vector<int>{0, 0, 1, 1, 1, 2, 2, 2, 2});
  CHECK(rows_between(2, {1, 3}, 3).part_down == doctest::Approx(1.0 / 3.0));
  CHECK(rows_between(6, {1, 3}, 3).part_down == doctest::Approx(2.0 / 3.0));
}

TEST_CASE("columns are interpolated each for itself") {
  RangeImage measured(2, 2);
  measured.range_m = {1, 10, 3, 30};
  CHECK(interpolate_rows(measured, {0, 2}, even_beams(3), Interpolation::kLinear).range_m ==
        Ranges{1, 10, 2, 20, 3, 30});
}

TEST_CASE("images that do not have the measured rows are refused") {
  const auto message = [](int measured, RowSelection rows, int all) {
    return error_message([&] {
      interpolate_rows(RangeImage(measured, 2), rows, even_beams(all), Interpolation::kLinear);
    });
  };
  CHECK(one_line_with(message(3, {0, 4}, 16), "interpolation", "3 x 2", "16 rows"));
  CHECK(message(5, {0, 4}, 16) != "no Error");
  CHECK(message(4, {0, 4}, 16) == "no Error");
  CHECK(message(4, {0, 0}, 4) != "no Error");
  CHECK(message(0, {4, 1}, 4) != "no Error");
  CHECK(message(4, {-1, 4}, 16) != "no Error");
}

}  // namespace hqslam::nn
