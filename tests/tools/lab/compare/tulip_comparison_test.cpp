#include "compare/tulip_comparison.h"

#include <doctest/doctest.h>

#include <cmath>

namespace hqslam::tools {
namespace {

constexpr double kDegree_rad = 3.14159265358979323846 / 180.0;

Eigen::Vector3f point(double elevation_deg, double azimuth_deg, double range_m) {
  const double e = elevation_deg * kDegree_rad;
  const double a = azimuth_deg * kDegree_rad;
  return Eigen::Vector3d(range_m * std::cos(e) * std::cos(a), range_m * std::cos(e) * std::sin(a),
                         range_m * std::sin(e))
      .cast<float>();
}

/// 10 m everywhere.
RangeImage full_image() {
  RangeImage image(64, 1024);
  image.range_m.assign(image.range_m.size(), 10.0F);
  return image;
}

}  // namespace

// Forward is column 512 of 1024; a column is 0.3516 degrees; TULIP's columns rise to the left, ours
// to the right. Truncation towards zero keeps two columns' width at 512.
TEST_CASE("points fall where TULIP puts them, on a grid that is turned over") {
  const auto pixel_of = [](const Eigen::Vector3f& p) {
    const RangeImage image = tulip_image({p});
    for (int row = 0; row < 64; ++row) {
      for (int column = 0; column < 1024; ++column) {
        if (image.at(row, column) > 0.0F) return std::pair{row, column};
      }
    }
    return std::pair{-1, -1};
  };
  CHECK(pixel_of(point(2.0, 0.01, 10.0)) == std::pair{0, 512});
  CHECK(pixel_of(point(-24.8, 0.0, 10.0)) == std::pair{63, 512});
  CHECK(pixel_of(point(0.0, 90.1, 10.0)) == std::pair{5, 256});  // left
  // Right: atan2(x, y) is -179.9 degrees; -269.9 / 0.3516 is cut to -767, so TULIP's column is
  // 1279 - 1024.
  CHECK(pixel_of(point(0.0, -90.1, 10.0)) == std::pair{5, 769});
  CHECK(pixel_of(point(0.0, 0.4, 10.0)) == std::pair{5, 511});
  CHECK(pixel_of(point(0.0, -0.4, 10.0)) == std::pair{5, 513});
  CHECK(pixel_of(point(2.3, 0.0, 10.0)) == std::pair{-1, -1});
  CHECK(pixel_of(point(-25.1, 0.0, 10.0)) == std::pair{-1, -1});
}

TEST_CASE("the point written last wins, and beyond 120 m it empties the pixel") {
  const auto range_m = [](double first_m, double second_m) {
    return tulip_image({point(0.0, 0.0, first_m), point(0.0, 0.0, second_m)}).at(5, 512);
  };
  CHECK(range_m(5.0, 50.0) == doctest::Approx(50.0));
  CHECK(range_m(50.0, 5.0) == doctest::Approx(5.0));
  CHECK(range_m(50.0, 130.0) == 0.0F);
}

TEST_CASE("the grid's elevations are those of the sensor that interpolation sees") {
  const SensorModel sensor = tulip_sensor();
  validate(sensor);
  CHECK(sensor.beam_elevation_rad.front() == doctest::Approx(2.0 * kDegree_rad));
  CHECK(sensor.beam_elevation_rad.back() == doctest::Approx(-24.8 * kDegree_rad));
  for (const int row : {0, 17, 63}) {
    const double elevation_deg = sensor.beam_elevation_rad[row] / kDegree_rad;
    CHECK(tulip_image({point(elevation_deg, 0.0, 10.0)}).at(row, 512) == doctest::Approx(10.0));
  }
}

TEST_CASE("a cloud has a point per pixel, less than two columns from where it was seen") {
  const RangeImage image = tulip_image({point(-10.0, 33.0, 20.0)});
  const std::vector<Eigen::Vector3f> points_m = tulip_points_m(image);
  REQUIRE(points_m.size() == 65536);
  int at_origin = 0;
  for (const Eigen::Vector3f& p : points_m) {
    if (p.isZero(0.0F)) {
      ++at_origin;
      continue;
    }
    CHECK(p.norm() == doctest::Approx(20.0));
    CHECK(std::atan2(p.y(), p.x()) / kDegree_rad == doctest::Approx(33.0).epsilon(0.02));
    CHECK(std::abs(std::asin(p.z() / p.norm()) / kDegree_rad + 10.0) < 0.22);
  }
  CHECK(at_origin == 65535);
}

// Rows 0, 4, ..., 60 are sixteen of the 64, and of the 48 that are computed.
TEST_CASE("the truth has no error; 1 m in a quarter of the rows is a quarter of a metre") {
  const RangeImage truth = full_image();
  const TulipScore none = tulip_score(truth, truth);
  CHECK(none.mae_m == 0.0);
  CHECK(none.chamfer_m2 == 0.0);
  CHECK(none.f1 == 1.0);
  RangeImage off = truth;
  for (int row = 0; row < 64; row += 4) {
    for (int column = 0; column < 1024; ++column) off.at(row, column) = 11.0F;
  }
  const TulipScore score = tulip_score(off, truth);
  CHECK(score.mae_m == doctest::Approx(0.25));
  CHECK(score.mae_computed_m == doctest::Approx(1.0 / 3.0));
  CHECK(score.f1 < 1.0);
  CHECK(score.precision < 1.0);
}

TEST_CASE("predictions outside 2 to 80 m are emptied, measured rows only after the mean error") {
  RangeImage truth = full_image();
  RangeImage upsampled = truth;
  upsampled.at(0, 0) = 81.0F;  // computed: stays empty, 10 m off
  upsampled.at(3, 0) = 1.0F;   // measured: counts 10 m, then the measured range is copied in
  const TulipScore score = tulip_score(upsampled, truth);
  CHECK(score.mae_m == doctest::Approx(20.0 / 65536.0));
  CHECK(score.mae_computed_m == doctest::Approx(10.0 / 49152.0));
  CHECK(score.chamfer_m2 < 0.01);  // one point of 65,536 at the sensor, 10 m from all others
  CHECK(score.chamfer_m2 > 100.0 / 65536.0 * 0.9);
}

}  // namespace hqslam::tools
