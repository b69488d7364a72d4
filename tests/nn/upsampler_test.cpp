#include "hqslam/nn/upsampler.h"

#include "small_network.h"

namespace hqslam::nn {

TEST_CASE("every interpolation has a name that leads back to it, and is what its upsampler does") {
  const SensorModel sensor = sensor_preset("os1-64");
  RangeImage measured(16, 1024);
  measured.at(0, 5) = 10.0F;
  measured.at(1, 5) = 14.0F;
  for (const std::string& name : interpolation_names()) {
    CHECK(is_interpolation(name));
    const Interpolation interpolation = interpolation_from_name(name);
    Upsampler upsampler(interpolation, sensor, {3, 4});
    CHECK(upsampler.run(measured).image.range_m ==
          interpolate_rows(measured, {3, 4}, sensor.beam_elevation_rad, interpolation).range_m);
    CHECK(upsampler.name() == name);
    CHECK(upsampler.network() == nullptr);
  }
  CHECK_FALSE(is_interpolation("sinc"));
  CHECK(refused_with([] { interpolation_from_name("sinc"); }, "sinc", "nearest, linear, inverse"));
}

TEST_CASE("an upsampler of a network alone is one for the network's own sensor") {
  const NetworkDescription description = small_du_or();
  const RangeImage measured = measured_scene(description);
  const Weights weights = small_weights(description);
  Upsampler upsampler(SuperResolver(weights, {}));
  Upsampler same(SuperResolver(weights, {}), small_sensor());
  CHECK(upsampler.sensor() == same.sensor());
  CHECK(upsampler.measured_rows() == RowSelection{3, 4});
  CHECK(upsampler.run(measured).image.range_m == same.run(measured).image.range_m);

  // What it upsamples: rows 3, 7, 11, 15 of 16, all of them measured.
  const SensorModel four = upsampler.measured_sensor();
  CHECK(four.rows() == 4);
  CHECK(four.columns == 64);
  CHECK(four.beam_elevation_rad[1] == small_sensor().beam_elevation_rad[7]);
  CHECK_FALSE(four.measured_rows);
}

}  // namespace hqslam::nn
