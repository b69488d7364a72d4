#include "train/right_share.h"

#include "testing.h"

namespace hqslam::tools {

TEST_CASE("a range counts as right within 0.1 m of what other scans measured, where they did") {
  nn::TrainingScan scan{RangeImage(4, 6)};  // row 1 and 3 are measured
  for (int column = 0; column < 6; ++column) scan.truth.at(1, column) = 7.0F;
  scan.truth.at(0, 0) = -10.0F;  // 10.05 m: right
  scan.truth.at(0, 1) = -10.2F;  // wrong
  scan.truth.at(0, 2) = -10.0F;  // left empty
  scan.truth.at(2, 3) = -9.98F;  // right
  scan.truth.at(2, 4) = nn::kUnknownTruth_m;
  scan.truth.at(2, 5) = 10.0F;  // the truth of a simulated scan: not asked for
  const auto upsample = [](const RangeImage& measured) {
    CHECK(measured.rows == 2);
    CHECK(measured.at(0, 3) == 7.0F);
    RangeImage image(4, 6);
    std::ranges::fill(image.range_m, 10.05F);
    image.at(0, 2) = 0.0F;
    return image;
  };
  nn::TrainingScan unknown{RangeImage(4, 6)};
  unknown.truth.at(1, 3) = 7.0F;
  const auto shares = pixel_shares({scan, unknown}, sensor_preset("os1-64"), {1, 2}, upsample);
  CHECK(shares.right == std::vector{0.5});
  CHECK(shares.missing == std::vector{0.25});
}

TEST_CASE("a gain over linear has the error of blocks of ten scans") {
  const std::vector<double> before(25, 0.5);
  std::vector<double> after(25, 0.6);
  for (int i = 10; i < 20; ++i) after[i] = 0.8;
  for (int i = 20; i < 25; ++i) after[i] = 9.0;  // no whole block
  const Gain gain = gain_of(before, after);
  CHECK(gain.mean == doctest::Approx(0.2));            // of 0.1 and 0.3
  CHECK(gain.standard_error == doctest::Approx(0.1));  // sqrt((0.01 + 0.01) / 1 / 2)
}

}  // namespace hqslam::tools
