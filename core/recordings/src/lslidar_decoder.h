#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "block_decoder.h"

namespace hqslam::recordings {

inline constexpr std::uint8_t kLslidarC16 = 0x10;

/// What a packet of measurements says of its sensor.
struct LslidarPacket {
  bool is_v4 = false;      ///< 1212 bytes, of version 4 and later; else 1206
  std::uint8_t model = 0;  ///< kLslidarC16 or another
  bool dual_return = false;
  std::int64_t second_ns = 0;  ///< when the packet ended; before version 4: 0
  std::int64_t fraction = 0;   ///< and so much later; before version 4: microseconds
};
/// Nothing if these are not the bytes of a packet of an LSLiDAR of 16 or 32 beams.
std::optional<LslidarPacket> lslidar_packet(Bytes payload);

/// A C16 of version 2.8, 3 (both: 1206 bytes) or 4.
struct LslidarUnit : BlockUnit {
  bool is_v4 = false;
  int fraction_ns = 1000;  ///< the unit of fractions: version 4 sends also nanoseconds
};
/// Without needs_angles those of version 3 are the manual's. path: stands for the recording in
/// messages. Throws Error for what is none of these, or has other angles.
LslidarUnit lslidar_unit(Bytes settings, const LslidarPacket& said, const std::string& path,
                         bool needs_angles = true);

/// Packets of an LSLiDAR C16 -> scans; see BlockDecoder.
///
/// A packet's time is that of its last channel. 16 channels fire 3.125 us apart, two returns stand
/// in two blocks. Distances are in 2.5 mm, those of version 4 in 4 mm. The beam begins 43 mm from
/// the axis, 14.68 degrees behind its azimuth; of version 4 36 mm, 20.25 degrees.
/// Sources: C16 user manual 3.5.2, "Communication protocol", "Accurate time calculation"; version
/// 4, the lens and the bytes of versions as the maker's open drivers have them.
class LslidarDecoder : public BlockDecoder {
 public:
  LslidarDecoder(const LslidarUnit& unit, const SensorModel& sensor,
                 const TurnDecoderOptions& options = {})
      : BlockDecoder(unit, sensor, options), is_v4_(unit.is_v4), fraction_ns_(unit.fraction_ns) {}

  /// Takes the next packet in and appends the scans that it completes.
  void add(const Packet& packet, std::vector<Scan>& completed);

 private:
  std::int64_t counted_us(std::int64_t now_us, std::int64_t capture_ns) const;

  bool is_v4_;
  int fraction_ns_;
  std::optional<std::int64_t> last_fraction_;  ///< of the packet before
  std::int64_t last_ns_ = 0;                   ///< its time
};

}  // namespace hqslam::recordings
