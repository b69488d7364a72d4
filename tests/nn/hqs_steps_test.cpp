#include "hqs/hqs_network.h"
#include "small_network.h"

// The loss and the result of the loop.
namespace hqslam::nn {

TEST_CASE("measured rows count as exact, equal values have no gradient") {
  Tensor z(1, 2, 2, ColumnPadding::kZero);
  Tensor truth = z;
  Tensor d_z = z;
  z.at(0, 0, 0) = 3.0F;
  truth.at(0, 0, 0) = 5.0F;
  z.at(0, 0, 1) = truth.at(0, 0, 1) = 2.0F;
  z.at(0, 1, 0) = 100.0F;
  for (int x = 0; x < 2; ++x) d_z.at(0, 1, x) = 9.0F;  // left from the last time
  CHECK(l1_loss(z, truth, {}, RowSelection{1, 2}, 1.0F, d_z) == doctest::Approx(0.5));
  CHECK(d_z.at(0, 0, 0) == -0.25F);
  CHECK(d_z.at(0, 0, 1) == 0.0F);
  CHECK(d_z.at(0, 1, 0) == 0.0F);
  CHECK(d_z.at(0, 1, 1) == 0.0F);
}

TEST_CASE("the result is in metres, within the sensor's limits, with the measured rows put back") {
  const HqsPlan description = small_du_or();
  std::vector<float> image(16 * 64, 0.25F);  // 20 m
  image[0] = 0.001F;                         // 0.08 m: too near
  image[1] = 1.6F;                           // 128 m: too far
  image[2] = -0.25F;
  image[3] = std::nanf("");
  image[4] = 1.5F;  // 120 m, the limit itself
  Tensor z(16, 4, 16, ColumnPadding::kCircular);
  to_tiles(image.data(), {4, 4}, z);
  RangeImage measured(4, 64);
  for (int i = 0; i < 4 * 64; ++i) measured.range_m[i] = 130.0F + static_cast<float>(i);
  measured.at(2, 5) = 0.0F;
  RangeImage result(16, 64);
  restore_rows(description, {4, 4}, z, measured, result);
  for (int column = 0; column < 4; ++column) CHECK(result.at(0, column) == 0.0F);
  CHECK(result.at(0, 4) == 120.0F);
  for (int row = 0; row < 16; ++row) {
    for (int column = 5; column < 64; ++column) {
      REQUIRE(result.at(row, column) == (row % 4 == 3 ? measured.at(row / 4, column) : 20.0F));
    }
  }
}

}  // namespace hqslam::nn
