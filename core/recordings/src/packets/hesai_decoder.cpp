#include "packets/hesai_decoder.h"

#include <cmath>
#include <numbers>

#include "hqslam/core/error.h"

namespace hqslam::recordings {

namespace {

constexpr int kHesaiBlocks = 8;
constexpr std::size_t kHeaderBytes = 12;
constexpr std::size_t kMeasurementBytes = 4;
constexpr std::size_t kTailBytes = 24;
constexpr std::size_t kNumberBytes = 4;
/// Behind the blocks.
constexpr std::size_t kReturnModeAt = 10;
constexpr std::size_t kTurnsPerMinuteAt = 11;
constexpr std::size_t kDateAt = 13;
constexpr std::size_t kMicrosecondsAt = 19;

constexpr double kFirstFiring_us = 5.632 + 0.368;
constexpr double kBlock_us = 50.0;
constexpr double kFastestTurn_us = 48.384;  ///< all lasers once
constexpr std::uint32_t kMostLost = 100'000'000;

std::size_t block_bytes(int lasers) {
  return 2 + kMeasurementBytes * static_cast<std::size_t>(lasers);
}
std::size_t tail_at(int lasers) { return kHeaderBytes + kHesaiBlocks * block_bytes(lasers); }

int azimuth_of(Bytes payload, int lasers, int block) {
  return little_endian<std::uint16_t>(
      payload, kHeaderBytes + static_cast<std::size_t>(block) * block_bytes(lasers));
}

}  // namespace

std::optional<HesaiPacket> hesai_packet(Bytes payload) {
  if (payload.size() < kHeaderBytes || payload[0] != 0xEE || payload[1] != 0xFF ||
      payload[2] != 6 || payload[7] != kHesaiBlocks) {
    return std::nullopt;
  }
  HesaiPacket header;
  header.lasers = payload[6];
  if (header.lasers != 16 && header.lasers != 32) return std::nullopt;
  const bool has_number = (payload[11] & 1U) != 0;
  const std::size_t tail = tail_at(header.lasers);
  if (payload.size() != tail + kTailBytes + (has_number ? kNumberBytes : 0)) return std::nullopt;
  for (int block = 0; block < kHesaiBlocks; ++block) {
    if (azimuth_of(payload, header.lasers, block) > kTurn) return std::nullopt;
  }
  const auto date = date_ns(1900 + payload[tail + kDateAt], payload.subspan(tail + kDateAt + 1, 5));
  const auto microseconds = little_endian<std::uint32_t>(payload, tail + kMicrosecondsAt);
  if (!date || microseconds > 1'000'000) return std::nullopt;
  header.time_ns = *date + 1000 * std::int64_t{microseconds};
  const int mode = payload[tail + kReturnModeAt];
  header.dual_return = mode == 0x39 || mode == 0x3B || mode == 0x3C;
  header.scan_period_s = period_at(little_endian<std::uint16_t>(payload, tail + kTurnsPerMinuteAt));
  if (has_number) header.number = little_endian<std::uint32_t>(payload, tail + kTailBytes);
  return header;
}

HesaiDecoder::HesaiDecoder(const SensorModel& sensor, const DecoderOptions& options,
                           std::string name)
    : TurnDecoder(sensor, std::move(name), 0, 360.0, options) {
  const int lasers = sensor.rows();
  if (lasers != 16 && lasers != 32) {
    throw Error(
        "sensor '{}' has {} rows, expected the 16 or 32 lasers of a Hesai XT; name its angle file",
        sensor.name, lasers);
  }
  for (int row = 0; row < lasers; ++row) {
    const double elevation_rad = sensor.beam_elevation_rad[row];
    const double offset_rad =
        hesai_half_firing_rad(sensor.scan_period_s) - sensor.beam_azimuth_offset_rad[row];
    lasers_.push_back({std::cos(elevation_rad), std::sin(elevation_rad), std::cos(offset_rad),
                       std::sin(offset_rad), 1e-6 * kFastestTurn_us * row / lasers});
  }
}

void HesaiDecoder::add(const Packet& packet) {
  const auto header = hesai_packet(packet.payload);
  if (!header || header->lasers != static_cast<int>(lasers_.size())) {
    ++counts_.foreign;
    return;
  }
  const int first = azimuth_of(packet.payload, header->lasers, 0);
  if (!take_time(header->time_ns, packet.capture_time_ns, header->scan_period_s, first)) return;
  if (header->number && last_number_) {
    const std::uint32_t missing = *header->number - *last_number_ - 1;
    if (missing < kMostLost) counts_.lost += missing;
  }
  last_number_ = header->number;
  ++counts_.used;
  const std::int64_t packet_ns = recorded_ns(header->time_ns, packet.capture_time_ns);
  const int step = header->dual_return ? 2 : 1;
  for (int block = 0; block < kHesaiBlocks; block += step) {
    const int later = (kHesaiBlocks - 1 - block) / step;
    const std::int64_t block_ns =
        packet_ns + std::llround(1e3 * (kFirstFiring_us - kBlock_us * later));
    const int azimuth = azimuth_of(packet.payload, header->lasers, block);
    const double start_s = fire(azimuth % kTurn, block_ns);
    if (options_.with_points) add_points(packet.payload, block, header->dual_return, start_s);
  }
}

void HesaiDecoder::add_points(Bytes payload, int block, bool dual, double start_s) {
  const int lasers = static_cast<int>(lasers_.size());
  const double unit_m = 1e-3 * payload[9];
  const double azimuth_rad = azimuth_of(payload, lasers, block) * 2.0 * std::numbers::pi / kTurn;
  const double cosine = std::cos(azimuth_rad);
  const double sine = std::sin(azimuth_rad);
  const auto measured = [&](int of_block, int laser) {
    const std::size_t at = kHeaderBytes + static_cast<std::size_t>(of_block) * block_bytes(lasers) +
                           2 + kMeasurementBytes * static_cast<std::size_t>(laser);
    return PulseReturn{little_endian<std::uint16_t>(payload, at), payload[at + 2]};
  };
  for (int i = 0; i < lasers; ++i) {
    PulseReturn measurement = measured(block, i);
    if (dual) measurement = kept_of(measurement, measured(block + 1, i), options_.kept_return);
    if (measurement.distance == 0 || payload[9] == 0) continue;
    const Laser& laser = lasers_[i];
    const double range_m = unit_m * measurement.distance;
    const double level_m = range_m * laser.cos_elevation;
    const double x_m = level_m * (sine * laser.cos_offset + cosine * laser.sin_offset);
    const double y_m = level_m * (cosine * laser.cos_offset - sine * laser.sin_offset);
    const double z_m = range_m * laser.sin_elevation;
    scan_.points_m.push_back(Eigen::Vector3d(x_m, y_m, z_m).cast<float>());
    scan_.row.push_back(static_cast<std::uint16_t>(i));
    scan_.intensity.push_back(measurement.reflectivity);
    scan_.time_offset_s.push_back(static_cast<float>(start_s + laser.time_s));
  }
}

}  // namespace hqslam::recordings
