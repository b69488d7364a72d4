#pragma once

#include "hqslam/core/angles.h"
#include "hqslam/core/npy.h"
#include "testing.h"

namespace hqslam::test {

/// Beams at these elevations that look along their column.
inline SensorModel beams_at(std::vector<double> elevation_rad, int columns) {
  SensorModel sensor;
  sensor.name = "made";
  sensor.columns = columns;
  sensor.beam_azimuth_offset_rad.assign(elevation_rad.size(), 0.0);
  sensor.beam_elevation_rad = std::move(elevation_rad);
  return sensor;
}

/// Beams `step_deg` apart, from `highest_deg` down.
inline SensorModel even_sensor(int rows, int columns, double highest_deg, double step_deg) {
  std::vector<double> elevation_deg(rows);
  for (int row = 0; row < rows; ++row) elevation_deg[row] = highest_deg - step_deg * row;
  return beams_at(radians(elevation_deg), columns);
}

/// Beams a degree apart, from 0 down.
inline SensorModel degrees_apart(int rows, int columns) {
  return even_sensor(rows, columns, 0.0, 1.0);
}

/// A preset with this many columns.
inline SensorModel preset_with(const std::string& name, int columns) {
  SensorModel sensor = sensor_preset(name);
  sensor.columns = columns;
  return sensor;
}

/// The same range in every pixel.
inline RangeImage flat_image(int rows, int columns, float range_m) {
  RangeImage image(rows, columns);
  image.range_m.assign(image.range_m.size(), range_m);
  return image;
}

/// The range of each pixel is range_m(row, column).
RangeImage made_image(int rows, int columns, const auto& range_m) {
  RangeImage image(rows, columns);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      image.at(row, column) = static_cast<float>(range_m(row, column));
    }
  }
  return image;
}
/// The same with the direction in which a sensor's pixel looks: range_m(row, column, direction).
RangeImage made_image(const SensorModel& sensor, const auto& range_m) {
  return made_image(sensor.rows(), sensor.columns, [&](int row, int column) {
    const double azimuth_rad = sensor.azimuth_rad(row, column);
    return range_m(row, column, direction_of(azimuth_rad, sensor.beam_elevation_rad[row]));
  });
}

/// A stack of these images.
inline void write_stack(const std::string& path, const std::vector<RangeImage>& images) {
  NpyStackWriter writer(path, images.front().rows, images.front().columns);
  for (const RangeImage& image : images) writer.append(image);
}

}  // namespace hqslam::test
