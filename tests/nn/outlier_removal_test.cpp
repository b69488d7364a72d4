#include "hqslam/nn/hqs/outlier_removal.h"

#include <doctest/doctest.h>

#include <cmath>

#include "hqslam/core/error.h"

using hqslam::nn::OutlierRemoval;

TEST_CASE("options that make no sense are refused") {
  const hqslam::SensorModel sensor = hqslam::sensor_preset("os1-64");
  const hqslam::RowSelection rows{3, 4};
  CHECK_NOTHROW(OutlierRemoval(sensor, rows, {}, sensor.columns));
  CHECK_NOTHROW(OutlierRemoval(sensor, rows, {}, 1));
  for (const double angle_rad : {0.0, -0.1, 1.5708, std::nan("")}) {
    CHECK_THROWS_AS(OutlierRemoval(sensor, rows, {.min_angle_rad = angle_rad}, 512), hqslam::Error);
  }
  CHECK_THROWS_AS(OutlierRemoval(sensor, rows, {.min_pixels = -1}, 512), hqslam::Error);
  for (const int columns : {0, -5, sensor.columns + 1}) {
    CHECK_THROWS_AS(OutlierRemoval(sensor, rows, {}, columns), hqslam::Error);
  }
  CHECK_THROWS_AS(OutlierRemoval(sensor, {-1, 4}, {}, 512), hqslam::Error);
  CHECK_THROWS_AS(OutlierRemoval(sensor, {3, 0}, {}, 512), hqslam::Error);
}
