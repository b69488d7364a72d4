#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "byte_reader.h"
#include "hqslam/core/sensor_model.h"
#include "packets/turn_decoder.h"

namespace hqslam::recordings {

/// The header of a packet.
struct HesaiPacket {
  int lasers = 0;
  bool dual_return = false;  ///< two blocks a firing
  double scan_period_s = 0.1;
  std::int64_t time_ns = 0;  ///< of the last firing's command, by the sensor's clock
  std::optional<std::uint32_t> number;
};
/// Nothing if these are not the bytes of a packet of an XT16 or XT32.
std::optional<HesaiPacket> hesai_packet(Bytes payload);

/// The head fires at multiples of 0.18 degrees (at 10 turns a second), which are the edges of
/// pixels: half of it is in the azimuth offsets of a sensor's beams, so that each pixel looks where
/// its laser does and no rounding decides between two of them.
double hesai_half_firing_rad(double scan_period_s);

/// The sensor as its angle file gives it: lines of channel, elevation, azimuth (degrees, clockwise)
/// after a line of names, 16 or 32 of them. Throws Error.
SensorModel read_hesai_angles(const std::string& path, double scan_period_s = 0.1);
/// The sensor of the manual, beams 2 degrees (16) or 1 degree (32) apart.
SensorModel nominal_hesai(int lasers, double scan_period_s = 0.1);

/// Packets of a Hesai XT16 or XT32 -> scans, in the frame of the maker's own drivers: x at the
/// azimuth of 90 degrees, y at 0.
///
/// In:  block b of a packet, 0 to 7: azimuth a_b; laser c: distance; the packet's time t.
/// Out: azimuth a_b + offset of the laser; time t + 5.632 us - 50 us (firings after this one) +
///      0.368 us + c step, the step 1.512 us (XT32) or 3.024 us (XT16).
/// A scan is one turn, cut at azimuth 0; see TurnDecoder. Sources: PandarXT user manual, "Point
/// cloud data packet" and appendix II; the numbers of appendix II as open drivers have them.
class HesaiDecoder : public TurnDecoder {
 public:
  /// `sensor` gives elevation and azimuth offset of each laser, 16 or 32, the latter with
  /// hesai_half_firing_rad. Throws Error for others.
  HesaiDecoder(const SensorModel& sensor, const DecoderOptions& options = {},
               std::string name = "");

  void add(const Packet& packet) override;

 private:
  struct Laser {
    double cos_elevation, sin_elevation, cos_offset, sin_offset;  ///< offset clockwise
    double time_s;                                                ///< after the block's begin
  };
  void add_points(Bytes payload, int block, bool dual, double start_s);

  std::vector<Laser> lasers_;
  std::optional<std::uint32_t> last_number_;  ///< of the packet before
};

}  // namespace hqslam::recordings
