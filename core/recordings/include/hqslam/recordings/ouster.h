#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/recordings/packet.h"
#include "hqslam/recordings/velodyne.h"

namespace hqslam::recordings {

/// How an Ouster lays out its lidar packets; the names are its own.
enum class OusterProfile { kLegacy, kRng19, kRng19Dual, kRng15, kFusaDual };

/// "LEGACY", "RNG19_RFL8_SIG16_NIR16", "RNG19_RFL8_SIG16_NIR16_DUAL", "RNG15_RFL8_NIR8",
/// "FUSA_RNG15_RFL8_NIR8_DUAL"
std::string_view name(OusterProfile profile);

/// What a sensor's metadata say of its packets.
struct OusterMetadata {
  /// Beams as project() has them: a column of the sensor looks along the left edge of a pixel, so
  /// half a column is added to the azimuth offsets of the file.
  SensorModel sensor;
  OusterProfile profile = OusterProfile::kLegacy;
  int columns_per_packet = 16;
  /// The columns that the sensor sends; a first one behind the last: over the end of the turn.
  int first_column = 0;
  int last_column = 0;
  /// Distance of the place where beams begin from the axis of rotation.
  double beam_origin_m = 0.0;
  std::string product;              ///< "OS-1-32-G", "" if the file does not say
  std::uint64_t serial_number = 0;  ///< 0 if the file does not say
  std::uint16_t lidar_port = 0;     ///< 0 if the file does not say

  bool in_window(int column) const {
    return first_column <= last_column ? column >= first_column && column <= last_column
                                       : column >= first_column || column <= last_column;
  }
  std::size_t packet_bytes() const;
  bool dual_return() const;
};

/// Reads the metadata that Ouster's sensors and recorders write beside a capture. Throws Error.
OusterMetadata read_ouster_metadata(const std::string& path);
/// The same for text; `source` stands for the file in messages.
OusterMetadata ouster_metadata_from_json(const std::string& text, const std::string& source);

/// One turn as the sensor sent it: rows x columns, not de-staggered.
struct OusterFrame {
  std::uint32_t frame_id = 0;
  std::vector<std::uint32_t> range_mm;         ///< the first (strongest) return; 0: none
  std::vector<std::uint32_t> second_range_mm;  ///< empty with a single return
  std::vector<std::uint64_t> timestamp_ns;     ///< per column, by the sensor's clock; 0: no column
  std::vector<std::uint16_t> measurement_id;   ///< per column; 0 where it never came
  std::vector<std::uint32_t> status;           ///< per column; bit 0: it is valid
  std::int64_t first_capture_ns = 0;           ///< of the packet that came first
  std::uint64_t first_timestamp_ns = 0;        ///< of that packet's first valid column
};

struct OusterOptions {
  KeptReturn kept_return = KeptReturn::kStrongest;  ///< kLast: the farther one
  /// Packets of any other sensor are foreign, where the profile says whose they are; 0: of none.
  std::uint64_t serial_number = 0;
  /// Whether ranges are read; without them frames are only counted and timed.
  bool with_ranges = true;
};

/// Ouster lidar packets -> frames. Columns of lost packets stay empty. A packet of an earlier frame
/// that was overtaken is left out and counted; one that came twice counts as late.
/// Source: Ouster sensor documentation, "Lidar data packet format".
class OusterDecoder {
 public:
  OusterDecoder(const OusterMetadata& metadata, const OusterOptions& options = {});
  ~OusterDecoder();
  OusterDecoder(OusterDecoder&&) noexcept;  ///< moved from: only assign or destroy

  /// Takes the next packet in and appends the frame that it completes.
  void add(const Packet& packet, std::vector<OusterFrame>& completed);
  /// The recording has ended: appends what is left.
  void finish(std::vector<OusterFrame>& completed);

  const PacketCounts& counts() const;
  /// Whole turns of which no packet came.
  std::int64_t lost_frames() const;
  /// Turns that were cut short by the beginning or the end of the recording.
  std::int64_t partial_frames() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// A frame with the time of its points.
struct OusterScan {
  double stamp_s = 0.0;  ///< the middle between its first and its last column
  OrganizedCloud cloud;
};

/// Frames -> points in the sensor's frame: x forward, y left, z up, origin on the axis of rotation
/// at the height of the beams' origin (Ouster's own sensor frame is 36 or 38 mm below it).
class OusterGeometry {
 public:
  OusterGeometry(const OusterMetadata& metadata, const OusterOptions& options = {});
  ~OusterGeometry();
  OusterGeometry(OusterGeometry&&) noexcept;  ///< moved from: only assign or destroy

  /// Nothing if no column of the frame is valid. Ranges beyond the sensor's are no return.
  std::optional<OusterScan> scan(const OusterFrame& frame);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hqslam::recordings
