#include "hqs/result.h"

#include <doctest/doctest.h>

#include "small_network.h"

namespace hqslam::nn {

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
      const float expected = row % 4 == 3 ? measured.at(row / 4, column) : 20.0F;
      REQUIRE(result.at(row, column) == expected);
    }
  }
}

}  // namespace hqslam::nn
