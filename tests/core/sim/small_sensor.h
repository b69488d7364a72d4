#pragma once

#include <numbers>

#include "hqslam/core/sensor_model.h"

namespace hqslam::test {

/// 16 beams from +10 to -20 degrees with azimuth offsets of some columns, 128 columns.
inline SensorModel small_sensor() {
  SensorModel sensor;
  sensor.name = "small";
  sensor.columns = 128;
  for (int row = 0; row < 16; ++row) {
    sensor.beam_elevation_rad.push_back((10.0 - 2.0 * row) * std::numbers::pi / 180.0);
    sensor.beam_azimuth_offset_rad.push_back((row % 2 == 0 ? 4.0 : -4.0) * std::numbers::pi /
                                             180.0);
  }
  return sensor;
}

}  // namespace hqslam::test
