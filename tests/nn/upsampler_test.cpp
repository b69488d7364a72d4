#include "hqslam/nn/upsampler.h"

#include <doctest/doctest.h>

#include "error_message.h"

namespace hqslam::nn {

using hqslam::test::error_message;
using hqslam::test::one_line_with;

TEST_CASE("every interpolation has a name that leads back to it") {
  for (const std::string& name : interpolation_names()) {
    CHECK(is_interpolation(name));
    const Upsampler upsampler(interpolation_from_name(name), sensor_preset("os1-64"), {3, 4});
    CHECK(upsampler.name() == name);
    CHECK(upsampler.network() == nullptr);
  }
  CHECK_FALSE(is_interpolation("cubic"));
  CHECK(one_line_with(error_message([] { interpolation_from_name("cubic"); }), "cubic",
                      "nearest, linear, inverse"));
}

TEST_CASE("an interpolating upsampler puts rows between the measured ones and leaves those alone") {
  Upsampler upsampler(Interpolation::kLinear, sensor_preset("os1-64"), {3, 4});
  RangeImage measured(16, 1024);
  measured.at(0, 5) = 10.0F;
  measured.at(1, 5) = 14.0F;
  const RangeImage image = upsampler.run(measured).image;
  CHECK(image.rows == 64);
  CHECK(image.at(3, 5) == 10.0F);
  CHECK(image.at(4, 5) == doctest::Approx(11.0));
  CHECK(image.at(7, 5) == 14.0F);
}

}  // namespace hqslam::nn
