#include "bench/bench_measurement.h"

#include <doctest/doctest.h>

#include <random>

#include "hqslam/core/connected_components.h"

namespace hqslam::tools {

TEST_CASE("the textbook baseline of the benchmark finds ComponentLabeler's components") {
  constexpr double kMinAngle_rad = 0.17453292519943295;
  SensorModel sensor = sensor_preset("os1-64");
  RangeImage image(sensor.rows(), sensor.columns);
  std::mt19937 generator(1);
  for (std::size_t i = 0; i < image.range_m.size(); ++i) {
    const auto random = static_cast<int>(generator() % 100);
    image.range_m[i] = random < 30 ? 0.0F : 10.0F + 0.02F * static_cast<float>(random);
  }
  ComponentLabeler labeler(sensor, {});
  CHECK(textbook_components(image, sensor, kMinAngle_rad) == labeler.label(image).label);
}

}  // namespace hqslam::tools
