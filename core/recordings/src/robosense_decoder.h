#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "byte_reader.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/recordings/scan_assembler.h"
#include "turn_decoder.h"

namespace hqslam::recordings {

/// Of packets of measurements (MSOP) and of settings (DIFOP).
inline constexpr std::size_t kRobosenseBytes = 1248;

/// What a packet of measurements says of its sensor.
struct RobosensePacket {
  bool helios = false;       ///< else an RS-16
  std::int64_t time_ns = 0;  ///< of its first firing, by the sensor's clock
};
/// Nothing if these are not the bytes of a packet of an RS-16 or a Helios.
std::optional<RobosensePacket> robosense_packet(Bytes payload);
/// Whether these are the bytes of a packet of settings of a RoboSense.
bool is_robosense_settings(Bytes payload);

/// What the settings say of a unit.
struct RobosenseUnit {
  bool helios = false;
  bool dual_return = false;
  double scan_period_s = 0.1;
  SensorModel sensor;                         ///< 16 or 32 rows, the highest first
  std::vector<std::uint16_t> row_of_channel;  ///< in the order in which the packets have them
};
/// helios: as the packets of measurements say. path: stands for the recording in messages. Throws
/// Error for what are no 16 or 32 beams.
RobosenseUnit robosense_unit(Bytes settings, bool helios, const std::string& path);

/// Packets of a RoboSense RS-16, Helios-16P or Helios with 32 beams -> scans; x at the azimuth 0,
/// which turns clockwise.
///
/// In:  12 blocks of an azimuth a_b and 32 measurements, of two firings of 16 channels or of one of
///      32; of two returns of one firing of 16, or two blocks of one of 32. The packet's time t.
/// Out: channel c of firing k: time t + k 55.5 us + c 2.8 us (RS-16), t + k 55.56 us + c 1.73 us
///      (Helios); azimuth interpolated in time between the blocks, + the channel's offset; the beam
///      begins 38 (RS-16) or 35 mm (Helios) before the axis.
/// A scan is one turn, cut at azimuth 0; see TurnDecoder. Sources: RS-LiDAR-16 and RS-Helios user
/// manuals, "MSOP" and "DIFOP"; times and lens as the maker's open driver has them.
class RobosenseDecoder : public TurnDecoder {
 public:
  /// sensor: of as many rows as the unit's, whose elevations and azimuth offsets are taken.
  RobosenseDecoder(const RobosenseUnit& unit, const SensorModel& sensor,
                   const VelodyneOptions& options = {});

  /// Takes the next packet in and appends the scans that it completes.
  void add(const Packet& packet, std::vector<Scan>& completed);

 private:
  struct Beam {
    double cos_elevation, sin_elevation, offset;  ///< hundredths of a degree, clockwise
  };
  struct Firing {
    int block = 0;          ///< where its measurements begin
    int first_channel = 0;  ///< and in the block
    double azimuth = 0.0;   ///< hundredths of a degree
    double time_us = 0.0;   ///< after the packet's time
    double rate = 0.0;      ///< of the azimuth, hundredths of a degree a microsecond
  };
  std::vector<Firing> firings_of(Bytes payload) const;
  void add_points(Bytes payload, const Firing& firing, double start_s);

  RobosenseUnit unit_;
  int channels_;
  std::vector<Beam> beams_;  ///< of each channel
};

/// Throws Error unless the sensor has as many rows as the unit.
std::unique_ptr<ScanAssembler> robosense_assembler(const RobosenseUnit& unit,
                                                   const SensorModel& sensor, std::string name,
                                                   const VelodyneOptions& options = {});

}  // namespace hqslam::recordings
