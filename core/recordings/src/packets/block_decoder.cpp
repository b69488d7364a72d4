#include "packets/block_decoder.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "hqslam/core/error.h"

namespace hqslam::recordings {

namespace {

constexpr std::array<std::uint8_t, 8> kSettingsBegin = {0xA5, 0xFF, 0x00, 0x5A,
                                                        0x11, 0x11, 0x55, 0x55};
constexpr std::size_t kSpeedAt = 8;

constexpr std::size_t kReturnsBlockBytes = 100;
constexpr std::size_t kReturnBytes = 3;
constexpr std::uint16_t kBlockBegin = 0xFFEE;

/// No head turns so far from block to block: what lies between is not looked at.
constexpr int kBlindAdvance = 100;

std::size_t block_at(const BlockFormat& format, int block) {
  return format.blocks_at + static_cast<std::size_t>(block) * kReturnsBlockBytes;
}
std::uint16_t number_at(Bytes payload, const BlockFormat& format, std::size_t at) {
  return format.big_endian ? big_endian_16(payload, at) : little_endian<std::uint16_t>(payload, at);
}
int azimuth_of(Bytes payload, const BlockFormat& format, int block) {
  return number_at(payload, format, block_at(format, block) + 2);
}

}  // namespace

bool has_blocks(Bytes payload, const BlockFormat& format) {
  for (int block = 0; block < kBlocksInPacket; ++block) {
    if (big_endian_16(payload, block_at(format, block)) != kBlockBegin) return false;
    if (azimuth_of(payload, format, block) > kTurn) return false;
  }
  return true;
}

bool is_settings(Bytes payload) {
  return payload.size() == kRobosenseBytes &&
         std::equal(kSettingsBegin.begin(), kSettingsBegin.end(), payload.begin());
}

double scan_period_of(Bytes settings) { return period_at(big_endian_16(settings, kSpeedAt)); }

BlockDecoder::BlockDecoder(const BlockUnit& unit, const SensorModel& sensor,
                           const TurnDecoderOptions& options, std::string name)
    : TurnDecoder(sensor, std::move(name), 0, 360.0, options),
      unit_(unit),
      channels_(static_cast<int>(unit.row_of_channel.size())) {
  if (sensor.rows() != channels_) {
    throw Error("sensor '{}' has {} rows, expected the {} of the recorded {}; leave it out",
                sensor.name, sensor.rows(), channels_, unit.sensor.name);
  }
  for (const std::uint16_t row : unit.row_of_channel) {
    const double elevation_rad = sensor.beam_elevation_rad[row];
    beams_.push_back({std::cos(elevation_rad), std::sin(elevation_rad),
                      -sensor.beam_azimuth_offset_rad[row] / kHundredth_rad});
  }
}

bool BlockDecoder::add_blocks(const Packet& packet, std::int64_t sensor_ns) {
  if (!take_time(sensor_ns, packet.capture_time_ns, unit_.scan_period_s)) return false;
  ++counts_.used;
  const std::vector<Firing> firings = firings_of(packet.payload);
  const double packet_s = 1e-6 * unit_.format.firing_us * static_cast<double>(firings.size());
  if (passed_s_ > 0.0) counts_.lost += std::max(0LL, std::llround(passed_s_ / packet_s) - 1);
  const std::int64_t packet_ns = recorded_ns(sensor_ns, packet.capture_time_ns);
  for (const Firing& firing : firings) {
    const std::int64_t firing_ns =
        packet_ns + std::llround(1e3 * (unit_.format.first_us + firing.time_us));
    const double start_s = fire(static_cast<int>(std::lround(firing.azimuth)) % kTurn, firing_ns);
    if (options_.with_points) add_points(packet.payload, firing, start_s);
  }
  return true;
}

std::vector<BlockDecoder::Firing> BlockDecoder::firings_of(Bytes payload) const {
  const double firing_us = unit_.format.firing_us;
  const bool halved = unit_.dual_return && !unit_.returns_in_blocks;
  const int step = unit_.dual_return && unit_.returns_in_blocks ? 2 : 1;  // blocks of a firing
  const int per_block = channels_ == 16 && !halved ? 2 : 1;
  const double block_us = per_block * firing_us;
  const double expected_rate = 1e-6 * kTurn / unit_.scan_period_s;
  std::vector<Firing> firings;
  double rate = expected_rate;
  double time_us = 0.0;
  for (int block = 0; block < kBlocksInPacket; block += step) {
    const int azimuth = azimuth_of(payload, unit_.format, block);
    double passed_us = block_us;
    if (block + step < kBlocksInPacket) {
      const int advance = modulo_turn(azimuth_of(payload, unit_.format, block + step) - azimuth);
      rate = advance > kBlindAdvance ? expected_rate : advance / block_us;
      if (advance > kBlindAdvance) passed_us = advance / expected_rate;
    }
    for (int i = 0; i < per_block; ++i) {
      firings.push_back(
          {block, 16 * i, azimuth + rate * i * firing_us, time_us + i * firing_us, rate});
    }
    time_us += passed_us;
  }
  return firings;
}

PulseReturn BlockDecoder::pulse_of(Bytes payload, const Firing& firing, int channel) const {
  const auto measured = [&](int block, int of_block) {
    const std::size_t at =
        block_at(unit_.format, block) + 4 + kReturnBytes * static_cast<std::size_t>(of_block);
    return PulseReturn{number_at(payload, unit_.format, at), payload[at + 2]};
  };
  const int first = firing.first_channel + channel;
  const PulseReturn pulse = measured(firing.block, first);
  if (!unit_.dual_return) return pulse;
  const PulseReturn other = unit_.returns_in_blocks ? measured(firing.block + 1, first)
                                                    : measured(firing.block, 16 + channel);
  return kept_of(pulse, other, options_.kept_return);
}

void BlockDecoder::add_points(Bytes payload, const Firing& firing, double start_s) {
  const BlockFormat& format = unit_.format;
  for (int i = 0; i < channels_; ++i) {
    const PulseReturn pulse = pulse_of(payload, firing, i);
    if (pulse.distance == 0) continue;
    const Beam& beam = beams_[i];
    const double later_us = format.channel_us * i;
    const double azimuth = firing.azimuth + firing.rate * later_us;
    const double lens_rad = (azimuth - format.lens_behind) * kHundredth_rad;
    const double beam_rad = (azimuth + beam.offset) * kHundredth_rad;
    const double range_m = format.unit_m * pulse.distance;
    const double level_m = range_m * beam.cos_elevation;
    const double x_m = level_m * std::cos(beam_rad) + format.lens_m * std::cos(lens_rad);
    const double y_m = -level_m * std::sin(beam_rad) - format.lens_m * std::sin(lens_rad);
    scan_.points_m.push_back(Eigen::Vector3d(x_m, y_m, range_m * beam.sin_elevation).cast<float>());
    scan_.row.push_back(unit_.row_of_channel[i]);
    scan_.intensity.push_back(pulse.reflectivity);
    scan_.time_offset_s.push_back(static_cast<float>(start_s + 1e-6 * later_us));
  }
}

}  // namespace hqslam::recordings
