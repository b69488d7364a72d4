#include "hesai_decoder.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "hqslam/core/error.h"

namespace hqslam::recordings {

namespace {

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
constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr double kWholeTurn = 0.99;
/// Two clocks that tell of the same gap differ by less.
constexpr double kMostApart_s = 0.5;
constexpr std::uint32_t kMostLost = 100'000'000;

std::size_t block_bytes(int lasers) {
  return 2 + kMeasurementBytes * static_cast<std::size_t>(lasers);
}
std::size_t tail_at(int lasers) { return kHeaderBytes + kHesaiBlocks * block_bytes(lasers); }

int azimuth_of(Bytes payload, int lasers, int block) {
  return little_endian<std::uint16_t>(
      payload, kHeaderBytes + static_cast<std::size_t>(block) * block_bytes(lasers));
}

/// Years since 1900, month, day, hour, minute, second, a byte each; nothing for what is no date.
std::optional<std::int64_t> date_ns(Bytes date) {
  using namespace std::chrono;
  const year_month_day day{year{1900 + date[0]}, month{date[1]}, std::chrono::day{date[2]}};
  if (!day.ok() || date[3] > 23 || date[4] > 59 || date[5] > 60) return std::nullopt;
  const std::int64_t days = sys_days{day}.time_since_epoch().count();
  return kSecond_ns * (86400 * days + 3600 * date[3] + 60 * date[4] + date[5]);
}

struct Measurement {
  std::uint16_t distance = 0;
  std::uint8_t reflectivity = 0;
};

/// Of two returns of a pulse, in whichever order the sensor was told to send them.
Measurement kept(Measurement a, Measurement b, KeptReturn which) {
  if (a.distance == 0 || b.distance == 0) return a.distance == 0 ? b : a;
  if (which == KeptReturn::kLast) return a.distance < b.distance ? b : a;
  return a.reflectivity < b.reflectivity ? b : a;
}

}  // namespace

std::optional<HesaiPacket> hesai_packet(Bytes payload) {
  if (payload.size() < kHeaderBytes || payload[0] != 0xEE || payload[1] != 0xFF ||
      payload[2] != 6 || payload[7] != kHesaiBlocks) {
    return std::nullopt;
  }
  HesaiPacket said;
  said.lasers = payload[6];
  if (said.lasers != 16 && said.lasers != 32) return std::nullopt;
  const bool has_number = (payload[11] & 1U) != 0;
  const std::size_t tail = tail_at(said.lasers);
  if (payload.size() != tail + kTailBytes + (has_number ? kNumberBytes : 0)) return std::nullopt;
  for (int block = 0; block < kHesaiBlocks; ++block) {
    if (azimuth_of(payload, said.lasers, block) > kTurn) return std::nullopt;
  }
  const auto date = date_ns(payload.subspan(tail + kDateAt, 6));
  const auto microseconds = little_endian<std::uint32_t>(payload, tail + kMicrosecondsAt);
  if (!date || microseconds > 1'000'000) return std::nullopt;
  said.time_ns = *date + 1000 * std::int64_t{microseconds};
  const int mode = payload[tail + kReturnModeAt];
  said.dual_return = mode == 0x39 || mode == 0x3B || mode == 0x3C;
  const int turns_per_minute = little_endian<std::uint16_t>(payload, tail + kTurnsPerMinuteAt);
  if (turns_per_minute > 100 && turns_per_minute < 3000) {  // 599 or 601 are 600
    said.scan_period_s = 60.0 / (10.0 * std::round(turns_per_minute / 10.0));
  }
  if (has_number) said.number = little_endian<std::uint32_t>(payload, tail + kTailBytes);
  return said;
}

HesaiDecoder::HesaiDecoder(const SensorModel& sensor, const VelodyneOptions& options)
    : TurnDecoder(0, 360.0, options) {
  const int lasers = sensor.rows();
  if (lasers != 16 && lasers != 32) {
    throw Error(
        "sensor '{}' has {} rows, expected the 16 or 32 lasers of a Hesai XT; name its angle file",
        sensor.name, lasers);
  }
  for (int row = 0; row < lasers; ++row) {
    const double elevation_rad = sensor.beam_elevation_rad[row];
    const double offset_rad = -sensor.beam_azimuth_offset_rad[row];
    lasers_.push_back({std::cos(elevation_rad), std::sin(elevation_rad), std::cos(offset_rad),
                       std::sin(offset_rad), 1e-6 * kFastestTurn_us * row / lasers});
  }
}

/// False if the packet is left out. Where nothing came for a turn, or a clock was set, the scan
/// ends.
bool HesaiDecoder::take_time(const HesaiPacket& said, std::int64_t capture_ns,
                             std::vector<Scan>& completed) {
  if (last_) {
    const std::int64_t passed_ns = said.time_ns - last_->time_ns;
    if (passed_ns <= 0 && passed_ns > -kSecond_ns) {
      ++counts_.late;
      return false;
    }
    const double passed_s = 1e-9 * static_cast<double>(passed_ns);
    const double recorded_s =
        1e-9 * (static_cast<double>(capture_ns) - static_cast<double>(last_capture_ns_));
    const bool clock_was_set = std::abs(passed_s - recorded_s) > kMostApart_s;
    const bool turned = passed_s >= kWholeTurn * said.scan_period_s;
    if (turned && !clock_was_set) {
      lost_scans_ += std::max<std::int64_t>(0, std::llround(passed_s / said.scan_period_s) - 1);
    }
    if (turned || passed_s < 0.0) finish(completed);
    if (said.number && last_->number) {
      const std::uint32_t missing = *said.number - *last_->number - 1;
      if (missing < kMostLost) counts_.lost += missing;
    }
  }
  last_ = said;
  last_capture_ns_ = capture_ns;
  return true;
}

void HesaiDecoder::add(const Packet& packet, std::vector<Scan>& completed) {
  const auto said = hesai_packet(packet.payload);
  if (!said || said->lasers != static_cast<int>(lasers_.size())) {
    ++counts_.foreign;
    return;
  }
  if (!take_time(*said, packet.capture_time_ns, completed)) return;
  ++counts_.used;
  const std::int64_t packet_ns = clock_.recorded_ns(said->time_ns, packet.capture_time_ns);
  const int step = said->dual_return ? 2 : 1;
  for (int block = 0; block < kHesaiBlocks; block += step) {
    const int later = (kHesaiBlocks - 1 - block) / step;
    const std::int64_t block_ns =
        packet_ns + std::llround(1e3 * (kFirstFiring_us - kBlock_us * later));
    const int azimuth = azimuth_of(packet.payload, said->lasers, block);
    const double start_s = fire(azimuth % kTurn, block_ns, completed);
    if (options_.with_points) add_points(packet.payload, block, said->dual_return, start_s);
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
    return Measurement{little_endian<std::uint16_t>(payload, at), payload[at + 2]};
  };
  for (int i = 0; i < lasers; ++i) {
    Measurement measurement = measured(block, i);
    if (dual) measurement = kept(measurement, measured(block + 1, i), options_.kept_return);
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
