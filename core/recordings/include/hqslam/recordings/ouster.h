#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hqslam/core/sensor_model.h"

namespace hqslam::recordings {

/// How an Ouster lays out its lidar packets; the names are its own.
enum class OusterProfile { kLegacy, kRng19, kRng19Dual, kRng15, kFusaDual };

/// "LEGACY", "RNG19_RFL8_SIG16_NIR16", "RNG19_RFL8_SIG16_NIR16_DUAL", "RNG15_RFL8_NIR8",
/// "FUSA_RNG15_RFL8_NIR8_DUAL"
std::string_view name(OusterProfile profile);

/// A sensor's metadata: its beams and the form of its packets.
struct OusterMetadata {
  /// Beams as project() has them: a column of the sensor looks along the left edge of a pixel, so
  /// half a column is added to the azimuth offsets of the file.
  SensorModel sensor;
  OusterProfile profile = OusterProfile::kLegacy;
  int columns_per_packet = 16;
  std::size_t pixels_per_column = 0;  ///< in a packet
  /// The pixel of each row of the sensor: old firmware sends pixels of beams that it lacks, too.
  std::vector<std::size_t> pixel_of_row;
  /// The columns that the sensor sends; a first one behind the last: over the end of the turn.
  int first_column = 0;
  int last_column = 0;
  /// Distance of the place where beams begin from the axis of rotation.
  double beam_origin_m = 0.0;
  std::uint64_t serial_number = 0;  ///< 0 if unknown
  std::uint16_t lidar_port = 0;     ///< 0 if unknown
  std::uint16_t imu_port = 0;       ///< 0 if unknown
  /// The layout of its packets of inertial data; LEGACY is read.
  std::string imu_profile = "LEGACY";
  /// Rotation of its inertial data into the frame of the scans.
  Eigen::Matrix3d R_sensor_imu = Eigen::Matrix3d::Identity();

  bool in_window(int column) const {
    return first_column <= last_column ? column >= first_column && column <= last_column
                                       : column >= first_column || column <= last_column;
  }
  std::size_t packet_bytes() const;
  bool dual_return() const;
};

/// Reads the metadata that Ouster's sensors and recorders write beside a capture. Throws Error.
OusterMetadata read_ouster_metadata(const std::string& path);
/// Reads metadata from text; `source` stands for the file in messages.
OusterMetadata ouster_metadata_from_json(const std::string& text, const std::string& source);

}  // namespace hqslam::recordings
