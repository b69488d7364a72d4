#include "hqslam/evaluation/image_error.h"

#include <doctest/doctest.h>

#include <limits>

#include "error_message.h"

using namespace hqslam;
using namespace hqslam::test;

TEST_CASE("errors of a small image are those done by hand") {
  RangeImage image(2, 3);
  RangeImage true_image(2, 3);
  image.range_m = {10, 0, 5, 7, 0, -1};
  true_image.range_m = {12, 3, 5, 0, 0, std::numeric_limits<float>::quiet_NaN()};
  const ImageError error = image_error(image, true_image);
  CHECK(error.pixels == 6);
  CHECK(error.valid_pixels == 2);
  CHECK(error.mae_all_m == doctest::Approx((2.0 + 3.0 + 0.0 + 7.0) / 6.0));
  CHECK(error.mae_valid_m == doctest::Approx(1.0));
  CHECK(error.missing_share == doctest::Approx(1.0 / 3.0));   // the 3 m of 12, 3 and 5
  CHECK(error.invented_share == doctest::Approx(1.0 / 3.0));  // the 7 m of 10, 5 and 7
}

TEST_CASE("images without a common return and empty images have no error of valid pixels") {
  RangeImage image(1, 2);
  RangeImage true_image(1, 2);
  image.range_m = {4, 0};
  true_image.range_m = {0, 2};
  const ImageError error = image_error(image, true_image);
  CHECK(error.mae_all_m == doctest::Approx(3.0));
  CHECK(error.valid_pixels == 0);
  CHECK(error.mae_valid_m == 0.0);
  CHECK(error.missing_share == 1.0);
  CHECK(image_error({}, {}).missing_share == 0.0);
  CHECK(image_error({}, {}).mae_all_m == 0.0);
}

TEST_CASE("images of different shapes are refused") {
  CHECK(one_line_with(error_message([] { image_error(RangeImage(2, 3), RangeImage(3, 2)); }),
                      "expected an image of 3 x 2", "found 2 x 3"));
}
