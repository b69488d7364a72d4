#include "packets/robosense_decoder.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "hqslam/core/error.h"

namespace hqslam::recordings {

namespace {

constexpr std::array<std::uint8_t, 8> kRs16Begin = {0x55, 0xAA, 0x05, 0x0A, 0x5A, 0xA5, 0x50, 0xA0};
constexpr std::array<std::uint8_t, 4> kHeliosBegin = {0x55, 0xAA, 0x05, 0x5A};

constexpr std::size_t kClockAt = 20;  ///< in a packet of measurements

// Of a packet of settings.
constexpr std::size_t kReturnModeInSettings = 300;
constexpr std::size_t kRs16AnglesAt = 1165;
constexpr std::size_t kHeliosElevationsAt = 468;
constexpr std::size_t kHeliosAzimuthsAt = 564;
constexpr std::size_t kAngleBytes = 3;

constexpr double kMaxRange_m = 150.0;

const BlockFormat& format_of(bool helios) {
  static constexpr BlockFormat kRs16 = {42, true, 55.5, 2.8, 0.005, 0.03825};
  static constexpr BlockFormat kHelios = {42, true, 55.56, 1.73, 0.0025, 0.03498};
  return helios ? kHelios : kRs16;
}

template <std::size_t N>
bool begins_with(Bytes payload, const std::array<std::uint8_t, N>& begin) {
  return std::equal(begin.begin(), begin.end(), payload.begin());
}

std::uint64_t big_endian(Bytes bytes) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8U | byte;
  return value;
}

std::optional<std::int64_t> time_of(Bytes payload, bool helios) {
  const Bytes time = payload.subspan(kClockAt, 10);
  if (helios) {
    constexpr std::uint64_t kMostSeconds = 4'000'000'000;
    const std::uint64_t seconds = big_endian(time.first(6));
    const std::uint64_t microseconds = big_endian(time.subspan(6));
    if (seconds > kMostSeconds || microseconds > 1'000'000) return std::nullopt;
    return static_cast<std::int64_t>(1'000'000'000 * seconds + 1000 * microseconds);
  }
  const auto date = date_ns(2000 + time[0], time.subspan(1, 5));
  const int milliseconds = big_endian_16(time, 6);
  const int microseconds = big_endian_16(time, 8);
  if (!date || milliseconds > 1000 || microseconds > 1000) return std::nullopt;
  return *date + 1'000'000LL * milliseconds + 1000LL * microseconds;
}

/// Hundredths of a degree: a sign and 16 bits; nothing for a beam that is not there.
std::optional<double> helios_angle(Bytes settings, std::size_t at, int channel) {
  at += kAngleBytes * static_cast<std::size_t>(channel);
  constexpr double kMost = 9000.0;
  const double angle = big_endian_16(settings, at + 1);
  if (settings[at] > 1 || angle > kMost) return std::nullopt;
  return settings[at] == 1 ? -angle : angle;
}

struct Angles {
  std::vector<double> elevation, azimuth;  ///< hundredths of a degree, azimuths clockwise
};

/// An RS-16's are 24 bits, ten thousandths of a degree; the first eight look down.
Angles rs16_angles(Bytes settings) {
  Angles angles;
  for (int channel = 0; channel < 16; ++channel) {
    const std::size_t at = kRs16AnglesAt + kAngleBytes * static_cast<std::size_t>(channel);
    const double angle = 0.01 * static_cast<double>(big_endian(settings.subspan(at, kAngleBytes)));
    angles.elevation.push_back(channel < 8 ? -angle : angle);
    angles.azimuth.push_back(0.0);
  }
  return angles;
}

/// As many as the sensor has; others repeat one, or are none.
Angles helios_angles(Bytes settings) {
  Angles angles;
  for (int channel = 0; channel < 32; ++channel) {
    const auto elevation = helios_angle(settings, kHeliosElevationsAt, channel);
    const auto azimuth = helios_angle(settings, kHeliosAzimuthsAt, channel);
    if (!elevation || !azimuth || std::ranges::count(angles.elevation, *elevation) > 0) break;
    angles.elevation.push_back(*elevation);
    angles.azimuth.push_back(*azimuth);
  }
  if (angles.elevation.size() >= 16 && angles.elevation.size() < 32) {
    angles.elevation.resize(16);
    angles.azimuth.resize(16);
  }
  return angles;
}

}  // namespace

std::optional<RobosensePacket> robosense_packet(Bytes payload) {
  if (payload.size() != kRobosenseBytes) return std::nullopt;
  RobosensePacket said;
  said.helios = begins_with(payload, kHeliosBegin);
  if (!said.helios && !begins_with(payload, kRs16Begin)) return std::nullopt;
  if (!has_blocks(payload, format_of(said.helios))) return std::nullopt;
  const auto time_ns = time_of(payload, said.helios);
  if (!time_ns) return std::nullopt;
  said.time_ns = *time_ns;
  return said;
}

RobosenseUnit robosense_unit(Bytes settings, bool helios, const std::string& path) {
  RobosenseUnit unit;
  unit.helios = helios;
  unit.format = format_of(helios);
  unit.dual_return = settings[kReturnModeInSettings] == 0;
  unit.scan_period_s = scan_period_of(settings);
  const Angles angles = helios ? helios_angles(settings) : rs16_angles(settings);
  std::vector<std::size_t> channels(angles.elevation.size());
  std::iota(channels.begin(), channels.end(), 0U);
  std::ranges::sort(channels, std::greater(), [&](std::size_t i) { return angles.elevation[i]; });
  SensorModel& sensor = unit.sensor;
  sensor.name = helios ? "helios" : "rs-16";
  sensor.columns = 1800;  // of 10 turns a second
  sensor.scan_period_s = unit.scan_period_s;
  sensor.min_range_m = 0.4;
  sensor.max_range_m = kMaxRange_m;
  unit.returns_in_blocks = channels.size() == 32;
  unit.row_of_channel.resize(channels.size());
  for (const std::size_t channel : channels) {
    unit.row_of_channel[channel] = static_cast<std::uint16_t>(sensor.rows());
    sensor.beam_elevation_rad.push_back(angles.elevation[channel] * kHundredth_rad);
    sensor.beam_azimuth_offset_rad.push_back(-angles.azimuth[channel] * kHundredth_rad);
  }
  try {
    if (sensor.rows() != 16 && sensor.rows() != 32) {
      throw Error("{} beams that differ", sensor.rows());
    }
    validate(sensor);
  } catch (const Error& error) {
    throw Error(
        "{}: expected the angles of 16 or 32 beams in the settings (DIFOP) of a RoboSense, found: "
        "{}; give its point clouds",
        path, error.what());
  }
  return unit;
}

void RobosenseDecoder::add(const Packet& packet) {
  const auto said = robosense_packet(packet.payload);
  if (said && said->helios == helios_) {
    add_blocks(packet, said->time_ns);
  } else {
    ++counts_.foreign;
  }
}

}  // namespace hqslam::recordings
