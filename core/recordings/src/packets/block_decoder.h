#pragma once

#include <cstdint>
#include <numbers>
#include <vector>

#include "byte_reader.h"
#include "hqslam/core/sensor_model.h"
#include "packets/turn_decoder.h"

namespace hqslam::recordings {

/// A packet: blocks of a mark (0xFF 0xEE), an azimuth and 32 measurements, a distance and a
/// reflectivity.
inline constexpr int kBlocksInPacket = 12;
inline constexpr double kHundredth_rad = std::numbers::pi / 18000.0;  ///< of a degree
/// Of a RoboSense's packets of measurements (MSOP) and of settings (DIFOP).
inline constexpr std::size_t kRobosenseBytes = 1248;

/// What a maker's packets have in common.
struct BlockFormat {
  std::size_t blocks_at = 0;
  bool big_endian = false;
  double firing_us = 0.0;    ///< all channels once
  double channel_us = 0.0;   ///< from channel to channel
  double unit_m = 0.0;       ///< of distances
  double lens_m = 0.0;       ///< where beams begin, from the axis,
  double lens_behind = 0.0;  ///< and so much behind the azimuth, hundredths of a degree
  double first_us = 0.0;     ///< the first firing, after the packet's time
};

/// A unit as its packets and its settings (DIFOP) tell of it.
struct BlockUnit {
  BlockFormat format;
  bool dual_return = false;
  /// The second return of a firing stands in the next block, else 16 channels behind the first one.
  bool returns_in_blocks = true;
  double scan_period_s = 0.1;
  SensorModel sensor;                         ///< 16 or 32 rows, the highest first
  std::vector<std::uint16_t> row_of_channel;  ///< in the order in which the packets have them
};

/// Whether each of the blocks, which the payload is long enough for, has its mark and an azimuth.
bool has_blocks(Bytes payload, const BlockFormat& format);
/// Whether these are the bytes of a packet of settings.
bool is_settings(Bytes payload);
/// From the settings; that of 10 turns a second where they do not say it.
double scan_period_of(Bytes settings);

/// What the decoders of packets of blocks share; x is at the azimuth 0, which turns clockwise.
///
/// In:  12 blocks; a block has two firings of 16 channels or one of 32, or two returns of one
///      firing of 16; or two blocks have the returns of the same firings. The packet's time t.
/// Out: channel c of firing k: time t + first_us + k firing_us + c channel_us; azimuth interpolated
///      in time between the blocks, + the channel's offset.
/// A scan is one turn, cut at azimuth 0; see TurnDecoder.
class BlockDecoder : public TurnDecoder {
 protected:
  /// sensor: of as many rows as the unit's, whose elevations and azimuth offsets are taken. Throws
  /// Error for another.
  BlockDecoder(const BlockUnit& unit, const SensorModel& sensor, const TurnDecoderOptions& options,
               std::string name);

  /// Takes in the next packet, of this time by the sensor's clock; false if it is late.
  bool add_blocks(const Packet& packet, std::int64_t sensor_ns);

  BlockUnit unit_;

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

  int channels_;
  std::vector<Beam> beams_;  ///< of each channel
};

}  // namespace hqslam::recordings
