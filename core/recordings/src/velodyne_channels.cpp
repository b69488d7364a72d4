#include "velodyne_channels.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "hqslam/core/error.h"

namespace hqslam::recordings {

namespace {

std::vector<int> rows_of(const VelodyneStream& stream) {
  if (stream.model != VelodyneModel::kHdl64e) return laser_rows(stream.model);
  std::vector<double> elevations_rad;
  for (const auto& laser : stream.calibration->lasers)
    elevations_rad.push_back(laser.elevation_rad);
  return rows_by_elevation(elevations_rad);
}

void check(const VelodyneStream& stream, const SensorModel& sensor, int lasers) {
  if (sensor.rows() != lasers) {
    throw Error(
        fmt::format("sensor '{}' has {} rows, expected the {} lasers of a {}; name the "
                    "sensor that recorded the packets",
                    sensor.name, sensor.rows(), lasers, name(stream.model)));
  }
  if (stream.model == VelodyneModel::kHdl64e &&
      (!stream.calibration || stream.calibration->lasers.size() != 64)) {
    throw Error("packets of an HDL-64E need the calibration of that unit: name its db.xml");
  }
}

}  // namespace

VelodyneTiming timing_of(const VelodyneStream& stream) {
  VelodyneTiming result = timing(stream.model);
  if (stream.model == VelodyneModel::kHdl64e && stream.packet_spacing_us > 0.0) {
    result.packet_us_single = stream.packet_spacing_us;
    result.firing_us = stream.packet_spacing_us / (kBlocks / 2.0);
  }
  return result;
}

VelodyneChannels channels_of(const VelodyneStream& stream, const SensorModel& sensor) {
  const VelodyneTiming timing = timing_of(stream);
  check(stream, sensor, timing.lasers);
  const std::vector<int> rows = rows_of(stream);
  VelodyneChannels result;
  for (int bank = 0; bank < static_cast<int>(result.size()); ++bank) {
    for (int c = 0; c < kChannels; ++c) {
      const int sequence = timing.lasers < kChannels ? c / timing.lasers : 0;
      const int laser = timing.lasers <= kChannels ? c % timing.lasers : bank * kChannels + c;
      if (laser >= timing.lasers) continue;  // a bank that the model has not
      const int row = rows[laser];
      VelodyneChannel channel;
      channel.row = static_cast<std::uint16_t>(row);
      channel.cos_elevation = static_cast<float>(std::cos(sensor.beam_elevation_rad[row]));
      channel.sin_elevation = static_cast<float>(std::sin(sensor.beam_elevation_rad[row]));
      channel.clockwise = -sensor.beam_azimuth_offset_rad[row] * 18000.0 / std::numbers::pi;
      if (stream.calibration) {
        const VelodyneCalibration::Laser& own = stream.calibration->lasers[laser];
        channel.distance_m = static_cast<float>(own.distance_m);
        channel.up_m = static_cast<float>(own.up_m);
        channel.left_m = static_cast<float>(own.left_m);
      }
      const double sequence_us = sequence * timing.firing_us;
      channel.time_us = sequence_us + laser_time_us(stream.model, laser);
      channel.azimuth_us = sequence_us + laser_azimuth_time_us(stream.model, laser);
      result[bank].push_back(channel);
    }
  }
  return result;
}

}  // namespace hqslam::recordings
