#include "hqslam/nn/training/drawn_beams.h"

#include "made_images.h"

namespace hqslam::nn {
namespace {

/// 272 rows, a quarter of a degree apart.
SensorModel many_rows() { return even_sensor(272, 64, 34.0, 0.25); }

}  // namespace

TEST_CASE("drawn sensors are valid ones of many kinds, the same for the same seed") {
  std::set<int> measured;
  std::set<int> columns;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    CAPTURE(seed);
    const DrawnBeams beams = draw_beams(many_rows(), seed);
    validate(beams.sensor);
    REQUIRE(beams.sensor.rows() == std::ssize(beams.rows));
    const int rows = beams.sensor.rows() / beams.measured_rows.stride;
    CHECK(rows * beams.measured_rows.stride == beams.sensor.rows());
    measured.insert(rows);
    columns.insert(beams.sensor.columns);
    CHECK(draw_beams(many_rows(), seed).rows == beams.rows);
  }
  CHECK(measured == std::set<int>{8, 16, 32, 64});
  CHECK(columns == std::set<int>{32, 64});
}

TEST_CASE("a drawn sensor sees its rows and columns of a scan, up to its range") {
  DrawnBeams beams = draw_beams(many_rows(), 3);
  beams.sensor.max_range_m = 100.0;
  const TrainingScan scan{
      made_image(272, 64, [](int row, int column) { return row + 0.01 * column; })};
  const TrainingScan seen = seen_by(beams, scan);
  CHECK(seen.truth.columns == 64 / beams.column_step);
  for (int row = 0; row < seen.truth.rows; ++row) {
    const float range_m = scan.truth.at(beams.rows[row], beams.column_step);
    CHECK(seen.truth.at(row, 1) == (range_m <= 100.0F ? range_m : 0.0F));
  }
}

TEST_CASE("the beams like a sensor's are the nearest ones") {
  const SensorModel like = preset_with("vlp-16", 32);
  const DrawnBeams beams = beams_like(many_rows(), like, {0, 1});
  for (int row = 0; row < 16; ++row) {
    CHECK(beams.sensor.beam_elevation_rad[row] ==
          doctest::Approx(like.beam_elevation_rad[row]).epsilon(1e-9));
  }
  CHECK(beams.column_step == 2);
}

}  // namespace hqslam::nn
