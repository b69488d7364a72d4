#include "lslidar_decoder.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "hqslam/core/error.h"
#include "velodyne_tables.h"

namespace hqslam::recordings {

namespace {

constexpr std::size_t kTimeOfPacketAt = 1200;
constexpr std::size_t kV4PacketBytes = 1212;
constexpr std::uint8_t kLslidarC32 = 0x20;

// Of a packet of settings.
constexpr std::size_t kVersionAt = 1196;
constexpr std::size_t kV4VersionAt = 1198;
constexpr std::size_t kAnglesAt = 245;

constexpr BlockFormat kV3Format = {0, false, 50.0, 3.125, 0.0025, 0.0431, 1468.0};
constexpr BlockFormat kV4Format = {0, false, 50.0, 3.125, 0.004, 0.0361, 2025.0};

constexpr int kRows = 16;
constexpr double kMiddleRow = 7.5;
/// A unit's beam is no farther from its table, hundredths of a degree.
constexpr double kMostOff = 150.0;

constexpr std::int64_t kPulse_us = 1'000'000;  ///< of a clock from outside
/// No recording has a longer gap.
constexpr double kMostGap_us = 1e11;

/// A low beam and a high one in turn, both from the bottom up.
int row_of(int channel) { return (channel % 2 == 0 ? 15 : 7) - channel / 2; }

/// A date, or seconds since 1970.
std::optional<std::int64_t> second_ns_of(Bytes time) {
  if (time[1] != 0) return date_ns(2000 + time[0], time.subspan(1, 5));
  const std::int64_t seconds = std::int64_t{big_endian_16(time, 2)} << 16 | big_endian_16(time, 4);
  return 1'000'000'000 * seconds;
}

/// By row, hundredths of a degree.
std::vector<double> angles_of(Bytes settings, const std::string& path) {
  std::vector<double> angles(kRows);
  for (int channel = 0; channel < kRows; ++channel) {
    const std::size_t at = kAnglesAt + 2 * static_cast<std::size_t>(channel);
    angles[row_of(channel)] = static_cast<std::int16_t>(big_endian_16(settings, at));
  }
  const bool falls = std::ranges::adjacent_find(angles, std::less_equal()) == angles.end();
  for (const double step : {200.0, 400.0 / 3.0}) {
    bool fits = falls;
    for (int row = 0; row < kRows; ++row) {
      fits = fits && std::abs(angles[row] - step * (kMiddleRow - row)) < kMostOff;
    }
    if (fits) return angles;
  }
  throw Error(
      "{}: expected the angles of 16 beams, 2 or 1.33 degrees apart, in the settings (DIFOP) of an "
      "LSLiDAR C16, found others; name a sensor that has them",
      path);
}

void check_version(Bytes settings, bool is_v4, const std::string& path) {
  const std::uint8_t major = settings[kVersionAt];
  const bool is_3 = major == 3 || (major == 2 && settings[kVersionAt + 1] >> 4 == 8);
  const bool is_4 = !is_3 && (settings[kV4VersionAt] & 0x0FU) == 4;
  if (is_v4 ? is_4 : is_3) return;
  throw Error(
      "{}: expected an LSLiDAR C16 of version 2.8 or 3 (packets of 1206 bytes) or 4 (1212), found "
      "packets of {} with version {:02x} {:02x} {:02x}, whose unit of distances is not known; give "
      "its point clouds",
      path, is_v4 ? kV4PacketBytes : kVelodynePacketBytes, major, settings[kVersionAt + 1],
      settings[kV4VersionAt]);
}

}  // namespace

std::optional<LslidarPacket> lslidar_packet(Bytes payload) {
  LslidarPacket said;
  said.is_v4 = payload.size() == kV4PacketBytes;
  if (!said.is_v4 && payload.size() != kVelodynePacketBytes) return std::nullopt;
  if (!has_blocks(payload, kV3Format)) return std::nullopt;
  const std::uint8_t returns = payload[payload.size() - 2];
  said.dual_return = returns == 0x39;
  said.model = payload.back();
  if (!said.is_v4) {  // else it is a Velodyne's
    if (returns < 0x37 || returns > 0x39) return std::nullopt;
    if (said.model != kLslidarC16 && said.model != kLslidarC32) return std::nullopt;
    said.fraction = little_endian<std::uint32_t>(payload, kTimeOfPacketAt);
    return said.fraction < kHour_us ? std::optional(said) : std::nullopt;
  }
  const auto second_ns = second_ns_of(payload.subspan(kTimeOfPacketAt, 6));
  said.fraction = little_endian<std::uint32_t>(payload, kTimeOfPacketAt + 6);
  if (!second_ns || said.fraction >= 1'000'000'000) return std::nullopt;
  said.second_ns = *second_ns;
  return said;
}

LslidarUnit lslidar_unit(Bytes settings, const LslidarPacket& said, const std::string& path,
                         bool needs_angles) {
  check_version(settings, said.is_v4, path);
  LslidarUnit unit;
  unit.is_v4 = said.is_v4;
  unit.format = said.is_v4 ? kV4Format : kV3Format;
  unit.dual_return = said.dual_return;
  const int firings = (said.dual_return ? 1 : 2) * kBlocksInPacket;
  unit.format.first_us = unit.format.channel_us - firings * unit.format.firing_us;
  unit.scan_period_s = scan_period_of(settings);
  unit.sensor.name = "c16";
  unit.sensor.columns = 2000;  // of 10 turns a second
  unit.sensor.scan_period_s = unit.scan_period_s;
  unit.sensor.min_range_m = 0.15;
  unit.sensor.max_range_m = said.is_v4 ? 200.0 : 150.0;
  std::vector<double> angles;
  if (!said.is_v4 && needs_angles) angles = angles_of(settings, path);
  for (int i = 0; i < kRows; ++i) {
    unit.row_of_channel.push_back(static_cast<std::uint16_t>(row_of(i)));
    const double angle = angles.empty() ? (said.is_v4 ? 1400 : 1500) - 200 * i : angles[i];
    unit.sensor.beam_elevation_rad.push_back(angle * kHundredth_rad);
  }
  unit.sensor.beam_azimuth_offset_rad.assign(kRows, 0.0);
  return unit;
}

/// The time of a packet by microseconds that begin anew every hour, or every second of a clock from
/// outside; the recorder's clock tells how many of these passed.
std::int64_t LslidarDecoder::counted_us(std::int64_t now_us, std::int64_t capture_ns) const {
  if (!last_fraction_) return now_us;
  const std::int64_t cycle_us =
      std::max(now_us, *last_fraction_) < kPulse_us ? kPulse_us : kHour_us;
  const std::int64_t passed_us = now_us - *last_fraction_;
  const double recorded_us =
      1e-3 * (static_cast<double>(capture_ns) - static_cast<double>(last_capture_ns_));
  const double missing_us =
      std::abs(recorded_us) < kMostGap_us ? recorded_us - static_cast<double>(passed_us) : 0.0;
  const std::int64_t cycles = std::llround(missing_us / static_cast<double>(cycle_us));
  return last_ns_ / 1000 + passed_us + cycles * cycle_us;
}

void LslidarDecoder::add(const Packet& packet, std::vector<Scan>& completed) {
  const auto said = lslidar_packet(packet.payload);
  if (!said || said->is_v4 != is_v4_ || said->model != kLslidarC16 ||
      said->dual_return != unit_.dual_return) {
    ++counts_.foreign;
    return;
  }
  const std::int64_t time_ns = is_v4_ ? said->second_ns + fraction_ns_ * said->fraction
                                      : 1000 * counted_us(said->fraction, packet.capture_time_ns);
  if (!add_blocks(packet, time_ns, completed)) return;
  last_fraction_ = said->fraction;
  last_ns_ = time_ns;
}

}  // namespace hqslam::recordings
