#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "byte_reader.h"
#include "hqslam/recordings/velodyne.h"
#include "packets/turn_decoder.h"

namespace hqslam::recordings {

/// A packet: 12 blocks of a flag, an azimuth and 32 measurements, a time and two factory bytes.
inline constexpr int kBlocks = 12;
inline constexpr int kChannels = 32;
inline constexpr std::size_t kBlockBytes = 100;
inline constexpr std::size_t kTimeAt = 1200;
inline constexpr std::size_t kProductAt = 1205;
inline constexpr std::int64_t kHour_us = 3'600'000'000;

/// How the lasers of a model fire.
struct VelodyneTiming {
  double distance_unit_m = 0.002;
  double firing_us = 0.0;         ///< all lasers once
  double block_firings = 1.0;     ///< of these in one block (of one return)
  double packet_us_single = 0.0;  ///< from packet to packet
  double packet_us_dual = 0.0;
  int lasers = 0;
  std::uint8_t product = 0;  ///< the factory byte
};

const VelodyneTiming& timing(VelodyneModel model);

/// When a laser fires after the first one of its firing sequence, microseconds.
double laser_time_us(VelodyneModel model, int laser);

/// The time that moves the azimuth on until the laser fires. A VLP-32C's lasers fire in pairs, but
/// in its recordings edges of things stand above one another only if the azimuth moves on by one of
/// its 24 steps per laser (measured: 0.0032 to 0.0045 degrees a laser where pairs would give 0);
/// other decoders have it so.
double laser_azimuth_time_us(VelodyneModel model, int laser);

/// The row of each laser, 0 the highest beam.
std::vector<int> laser_rows(VelodyneModel model);

/// By the manual, degrees: what laser_rows goes by. Not of an HDL-64E.
std::vector<double> laser_elevations_deg(VelodyneModel model);

/// The models whose lasers have the angles of their manuals.
inline constexpr std::array<VelodyneModel, 4> kVelodyneModels = {
    VelodyneModel::kVlp16, VelodyneModel::kHdl32e, VelodyneModel::kVlp32c, VelodyneModel::kVls128};

inline std::uint16_t block_flag(Bytes payload, int index) {
  return little_endian<std::uint16_t>(payload, kBlockBytes * static_cast<std::size_t>(index));
}
/// Hundredths of a degree as the packet has them: 36000, which real sensors send, is 0; more is
/// damage.
inline int raw_azimuth(Bytes payload, int index) {
  return little_endian<std::uint16_t>(payload, kBlockBytes * static_cast<std::size_t>(index) + 2);
}
inline int block_azimuth(Bytes payload, int index) { return raw_azimuth(payload, index) % kTurn; }

/// The flags of blocks: lasers 0 to 31, and for sensors with more lasers the following ones.
inline constexpr std::array<std::uint16_t, 4> kBankFlags = {0xEEFF, 0xDDFF, 0xCCFF, 0xBBFF};

/// Which 32 lasers a block is of, 0 to 3; -1 if it is none.
int bank_of(std::uint16_t flag);

/// How many blocks of a packet hold measurements: all, but of a VLS-128's with two returns the
/// first eight, two of each bank; the others are there to fill it.
int used_blocks(Bytes payload);

/// Whether these are the bytes of a Velodyne's data packet: its size, flags and azimuths.
bool is_velodyne_packet(Bytes payload);

/// A laser as one channel of a block.
struct VelodyneChannel {
  std::uint16_t row = 0;
  float cos_elevation = 1.0F;
  float sin_elevation = 0.0F;
  double clockwise = 0.0;   ///< hundredths of a degree
  double time_us = 0.0;     ///< after the first firing of the block
  double azimuth_us = 0.0;  ///< the same, for the interpolation of the azimuth
};

/// The channels of a block, by its bank.
using VelodyneChannels = std::array<std::vector<VelodyneChannel>, kBankFlags.size()>;

/// `sensor` gives elevation and azimuth offset of each row. Throws Error if it has not as many rows
/// as the model lasers.
VelodyneChannels channels_of(const VelodyneStream& stream, const SensorModel& sensor);

}  // namespace hqslam::recordings
