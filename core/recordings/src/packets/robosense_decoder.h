#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "packets/block_decoder.h"

namespace hqslam::recordings {

/// The header of a packet of measurements.
struct RobosensePacket {
  bool helios = false;       ///< else an RS-16
  std::int64_t time_ns = 0;  ///< of its first firing, by the sensor's clock
};
/// Nothing if these are not the bytes of a packet of an RS-16 or a Helios.
std::optional<RobosensePacket> robosense_packet(Bytes payload);

/// A unit, from its settings.
struct RobosenseUnit : BlockUnit {
  bool helios = false;
};
/// helios: as in the packets of measurements. path: stands for the recording in messages. Throws
/// Error unless there are 16 or 32 beams.
RobosenseUnit robosense_unit(Bytes settings, bool helios, const std::string& path);

/// Packets of a RoboSense RS-16, Helios-16P or Helios with 32 beams -> scans; see BlockDecoder.
///
/// A packet's time is that of its first firing. Channels fire 2.8 us apart every 55.5 us (RS-16),
/// 1.73 us every 55.56 us (Helios); the beam begins 38 (RS-16) or 35 mm (Helios) before the axis.
/// Sources: RS-LiDAR-16 and RS-Helios user manuals, "MSOP" and "DIFOP"; times and lens as the
/// maker's open driver has them.
class RobosenseDecoder : public BlockDecoder {
 public:
  RobosenseDecoder(const RobosenseUnit& unit, const SensorModel& sensor,
                   const TurnDecoderOptions& options = {}, std::string name = "")
      : BlockDecoder(unit, sensor, options, std::move(name)), helios_(unit.helios) {}

  void add(const Packet& packet) override;

 private:
  bool helios_;
};

}  // namespace hqslam::recordings
