#include "tools/program/ouster_drive.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <numbers>

#include "hqslam/core/npy.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/recordings/ouster.h"

namespace hqslam::test {

namespace {

constexpr std::int64_t kStart_ns = 1'000'000'000;

std::string metadata_of(const SensorModel& sensor) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  std::vector<double> altitude_deg;
  std::vector<double> azimuth_deg;
  for (int row = 0; row < sensor.rows(); ++row) {
    altitude_deg.push_back(kDegrees * sensor.beam_elevation_rad[row]);
    // Clockwise, and from the left edge of a pixel.
    azimuth_deg.push_back(-kDegrees *
                          (sensor.beam_azimuth_offset_rad[row] - sensor.column_step_rad() / 2.0));
  }
  return fmt::format(
      R"({{"beam_altitude_angles": [{}], "beam_azimuth_angles": [{}], "lidar_mode": "{}x10",
 "lidar_origin_to_beam_origin_mm": 0.0, "prod_line": "OS-1-{}"}})",
      fmt::join(altitude_deg, ", "), fmt::join(azimuth_deg, ", "), sensor.columns, sensor.rows());
}

/// 16 columns of a turn, from `first` on. Source: captures.cpp's, with ranges of an image.
Payload packet_of(const RangeImage& image, const recordings::OusterMetadata& metadata,
                  std::int64_t turn, int first) {
  const SensorModel& sensor = metadata.sensor;
  Payload bytes(metadata.packet_bytes());
  const std::size_t column_bytes = bytes.size() / 16;
  const double turn_ns = 1e9 * sensor.scan_period_s;
  for (int i = 0; i < 16; ++i) {
    const int measured = first + i;
    const std::size_t at = column_bytes * static_cast<std::size_t>(i);
    const double time_ns =
        turn_ns * (static_cast<double>(turn) + (measured + 0.5) / sensor.columns);
    put(bytes, at, kStart_ns + std::llround(time_ns));
    put(bytes, at + 8, static_cast<std::uint16_t>(measured));
    put(bytes, at + 10, static_cast<std::uint16_t>(turn));
    put(bytes, at + column_bytes - 4, std::uint32_t{0xFFFFFFFF});
  }
  for (int row = 0; row < sensor.rows(); ++row) {
    for (int column = 0; column < sensor.columns; ++column) {
      const int i = sensor.firing_column(row, column) - first;
      if (i < 0 || i >= 16) continue;
      const float range_m = image.range_m[static_cast<std::size_t>(row) * image.columns + column];
      put(bytes,
          column_bytes * static_cast<std::size_t>(i) + 16 + 12 * static_cast<std::size_t>(row),
          static_cast<std::uint32_t>(std::lround(1e3F * range_m)));
    }
  }
  return bytes;
}

}  // namespace

OusterDrive ouster_drive(const std::string& folder) {
  OusterDrive drive;
  drive.metadata = metadata_of(read_sensor_json(folder + "/sensor.json"));
  const auto metadata = recordings::ouster_metadata_from_json(drive.metadata, folder);
  NpyStackReader images(folder + "/scans.npy");
  for (std::int64_t turn = 0; turn < images.images(); ++turn) {
    const RangeImage image = images.read(turn);
    for (int first = 0; first < image.columns; first += 16) {
      const double turns = static_cast<double>(turn) + (first + 16.0) / image.columns;
      drive.packets.push_back(
          {kStart_ns + std::llround(1e9 * metadata.sensor.scan_period_s * turns), 7502,
           packet_of(image, metadata, turn, first)});
    }
  }
  return drive;
}

}  // namespace hqslam::test
