#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/sensor_model.h"
#include "packets/turn_decoder.h"

namespace hqslam::recordings {

/// Bytes of a packet of measurements (MSOP) or of settings (DIFOP).
inline constexpr std::size_t kRobosenseBytes = 1248;

/// The header of a packet of measurements.
struct RobosensePacket {
  bool helios = false;       ///< else an RS-16
  std::int64_t time_ns = 0;  ///< of its first firing, by the sensor's clock
};
/// Nothing if these are not the bytes of a packet of an RS-16 or a Helios.
std::optional<RobosensePacket> robosense_packet(Bytes payload);

/// Whether these are the bytes of a packet of settings.
bool is_settings(Bytes payload);

/// A unit, from its settings.
struct RobosenseUnit {
  bool helios = false;
  bool dual_return = false;
  SensorModel sensor;                         ///< 16 or 32 rows, the highest first
  std::vector<std::uint16_t> row_of_channel;  ///< in the order in which the packets have them
};
/// helios: as in the packets of measurements. path: stands for the recording in messages. Throws
/// Error unless there are 16 or 32 beams.
RobosenseUnit robosense_unit(Bytes settings, bool helios, const std::string& path);

/// Packets of a RoboSense RS-16, Helios-16P or Helios with 32 beams -> scans; x is at the azimuth
/// 0, which turns clockwise.
///
/// In:  12 blocks of a mark (0xFF 0xEE), an azimuth and 32 measurements, a distance and a
///      reflectivity. A block has two firings of 16 channels or one of 32, or two returns of one
///      firing of 16; or two blocks have the returns of the same firing of 32. The packet's time t.
/// Out: channel c of firing k: time t + k firing_us + c channel_us; azimuth interpolated in time
///      between the blocks, + the channel's offset. Channels fire 2.8 us apart every 55.5 us
///      (RS-16), 1.73 us every 55.56 us (Helios); the beam begins 38 (RS-16) or 35 mm (Helios)
///      before the axis.
/// A scan is one turn, cut at azimuth 0; see TurnDecoder.
/// Sources: RS-LiDAR-16 and RS-Helios user manuals, "MSOP" and "DIFOP"; times and lens as the
/// maker's open driver has them.
class RobosenseDecoder : public TurnDecoder {
 public:
  /// sensor: of as many rows as the unit's, whose elevations and azimuth offsets are taken. Throws
  /// Error for another.
  RobosenseDecoder(const RobosenseUnit& unit, const SensorModel& sensor,
                   const DecoderOptions& options = {}, std::string name = "");

  void add(const Packet& packet) override;

 private:
  struct Beam {
    double cos_elevation, sin_elevation, offset;  ///< hundredths of a degree, clockwise
  };
  struct Firing {
    int block = 0;          ///< where its measurements begin
    int first_channel = 0;  ///< and in the block
    double azimuth = 0.0;   ///< hundredths of a degree
    double time_us = 0.0;   ///< after the first firing
    double rate = 0.0;      ///< of the azimuth, hundredths of a degree a microsecond
  };
  std::vector<Firing> firings_of(Bytes payload) const;
  PulseReturn pulse_of(Bytes payload, const Firing& firing, int channel) const;
  void add_points(Bytes payload, const Firing& firing, double start_s);

  RobosenseUnit unit_;
  int channels_;
  std::vector<Beam> beams_;  ///< of each channel
};

}  // namespace hqslam::recordings
