#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/recordings/captures.h"
#include "hqslam/core/angles.h"
#include "hqslam/core/npy.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/recordings/ouster.h"

namespace hqslam::test {

/// A simulated drive as an Ouster would have sent it: packets of the legacy layout.
struct OusterDrive {
  std::string metadata;  ///< of the sensor, as text
  std::vector<Captured> packets;
};

inline std::string metadata_of(const SensorModel& sensor) {
  std::vector<double> altitude_deg;
  std::vector<double> azimuth_deg;
  for (int row = 0; row < sensor.rows(); ++row) {
    altitude_deg.push_back(degrees(sensor.beam_elevation_rad[row]));
    // Clockwise, and from the left edge of a pixel.
    azimuth_deg.push_back(
        -degrees(sensor.beam_azimuth_offset_rad[row] - sensor.column_step_rad() / 2.0));
  }
  return fmt::format(
      R"({{"beam_altitude_angles": [{}], "beam_azimuth_angles": [{}], "lidar_mode": "{}x10",
 "lidar_origin_to_beam_origin_mm": 0.0, "prod_line": "OS-1-{}"}})",
      fmt::join(altitude_deg, ", "), fmt::join(azimuth_deg, ", "), sensor.columns, sensor.rows());
}

/// folder: written by `hqslam-lab simulate` for an os1-16 or os1-64.
inline OusterDrive ouster_drive(const std::string& folder) {
  OusterDrive drive;
  drive.metadata = metadata_of(read_sensor_json(folder + "/sensor.json"));
  const auto metadata = recordings::ouster_metadata_from_json(drive.metadata, folder);
  const SensorModel& sensor = metadata.sensor;
  NpyStackReader images(folder + "/scans.npy");
  for (std::int64_t turn = 0; turn < images.images(); ++turn) {
    const RangeImage image = images.read(turn);
    const auto range_mm = [&](int row, int measured) {
      const int column = (measured - sensor.column_shift(row) + image.columns) % image.columns;
      return static_cast<std::uint32_t>(std::lround(1e3F * image.at(row, column)));
    };
    for (Captured& packet : ouster_turn(metadata, static_cast<std::uint32_t>(turn), range_mm)) {
      drive.packets.push_back(std::move(packet));
    }
  }
  return drive;
}

}  // namespace hqslam::test
