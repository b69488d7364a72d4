#include "packets/robosense_decoder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "hqslam/core/error.h"

namespace hqslam::recordings {

namespace {

constexpr std::array<std::uint8_t, 8> kRs16Begin = {0x55, 0xAA, 0x05, 0x0A, 0x5A, 0xA5, 0x50, 0xA0};
constexpr std::array<std::uint8_t, 4> kHeliosBegin = {0x55, 0xAA, 0x05, 0x5A};

// A packet of measurements.
constexpr std::size_t kClockAt = 20;
constexpr std::size_t kBlocksAt = 42;
constexpr int kBlocksOfPacket = 12;
constexpr std::size_t kBlockBytes = 100;
constexpr std::size_t kReturnBytes = 3;
constexpr std::uint16_t kBlockBegin = 0xFFEE;

// A packet of settings.
constexpr std::array<std::uint8_t, 8> kSettingsBegin = {0xA5, 0xFF, 0x00, 0x5A,
                                                        0x11, 0x11, 0x55, 0x55};
constexpr std::size_t kSpeedAt = 8;
constexpr std::size_t kReturnModeInSettings = 300;
constexpr std::size_t kRs16AnglesAt = 1165;
constexpr std::size_t kHeliosElevationsAt = 468;
constexpr std::size_t kHeliosAzimuthsAt = 564;
constexpr std::size_t kAngleBytes = 3;

constexpr double kMaxRange_m = 150.0;
constexpr double kHundredth_rad = std::numbers::pi / 18000.0;  ///< of a degree

/// No head turns farther from block to block: the sensor measures nothing between them.
constexpr int kBlindAdvance = 100;

/// What the two models have different in the same packet.
struct Timing {
  double firing_us = 0.0;   ///< all channels once
  double channel_us = 0.0;  ///< from channel to channel
  double unit_m = 0.0;      ///< of distances
  double lens_m = 0.0;      ///< where beams begin, from the axis
};
const Timing& timing_of(bool helios) {
  static constexpr Timing kRs16 = {55.5, 2.8, 0.005, 0.03825};
  static constexpr Timing kHelios = {55.56, 1.73, 0.0025, 0.03498};
  return helios ? kHelios : kRs16;
}

std::size_t block_at(int block) {
  return kBlocksAt + static_cast<std::size_t>(block) * kBlockBytes;
}
int azimuth_of(Bytes payload, int block) { return big_endian_16(payload, block_at(block) + 2); }

/// Whether each of the blocks, which the payload is long enough for, has its mark and an azimuth.
bool has_blocks(Bytes payload) {
  for (int block = 0; block < kBlocksOfPacket; ++block) {
    if (big_endian_16(payload, block_at(block)) != kBlockBegin) return false;
    if (azimuth_of(payload, block) > kTurn) return false;
  }
  return true;
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

/// Elevations of an RS-16: 24 bits each, ten thousandths of a degree, negative for the first eight.
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
  RobosensePacket header;
  header.helios = begins_with(payload, kHeliosBegin);
  if (!header.helios && !begins_with(payload, kRs16Begin)) return std::nullopt;
  if (!has_blocks(payload)) return std::nullopt;
  const auto time_ns = time_of(payload, header.helios);
  if (!time_ns) return std::nullopt;
  header.time_ns = *time_ns;
  return header;
}

bool is_settings(Bytes payload) {
  return payload.size() == kRobosenseBytes && begins_with(payload, kSettingsBegin);
}

RobosenseUnit robosense_unit(Bytes settings, bool helios, const std::string& path) {
  RobosenseUnit unit;
  unit.helios = helios;
  unit.dual_return = settings[kReturnModeInSettings] == 0;
  const Angles angles = helios ? helios_angles(settings) : rs16_angles(settings);
  std::vector<std::size_t> channels(angles.elevation.size());
  std::iota(channels.begin(), channels.end(), 0U);
  std::ranges::sort(channels, std::greater(), [&](std::size_t i) { return angles.elevation[i]; });
  SensorModel& sensor = unit.sensor;
  sensor.name = helios ? "helios" : "rs-16";
  sensor.columns = 1800;  // of 10 turns a second
  sensor.scan_period_s = period_at(big_endian_16(settings, kSpeedAt));
  sensor.min_range_m = 0.4;
  sensor.max_range_m = kMaxRange_m;
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

RobosenseDecoder::RobosenseDecoder(const RobosenseUnit& unit, const SensorModel& sensor,
                                   const DecoderOptions& options, std::string name)
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

void RobosenseDecoder::add(const Packet& packet) {
  const auto header = robosense_packet(packet.payload);
  if (!header || header->helios != unit_.helios) {
    ++counts_.foreign;
    return;
  }
  const double period_s = unit_.sensor.scan_period_s;
  const int first = azimuth_of(packet.payload, 0);
  if (!take_time(header->time_ns, packet.capture_time_ns, period_s, first)) return;
  ++counts_.used;
  const std::vector<Firing> firings = firings_of(packet.payload);
  const double packet_s =
      1e-6 * timing_of(unit_.helios).firing_us * static_cast<double>(firings.size());
  if (passed_s_ > 0.0) counts_.lost += std::max(0LL, std::llround(passed_s_ / packet_s) - 1);
  const std::int64_t packet_ns = recorded_ns(header->time_ns, packet.capture_time_ns);
  for (const Firing& firing : firings) {
    const std::int64_t firing_ns = packet_ns + std::llround(1e3 * firing.time_us);
    const double start_s = fire(static_cast<int>(std::lround(firing.azimuth)) % kTurn, firing_ns);
    if (options_.with_points) add_points(packet.payload, firing, start_s);
  }
}

std::vector<RobosenseDecoder::Firing> RobosenseDecoder::firings_of(Bytes payload) const {
  const double firing_us = timing_of(unit_.helios).firing_us;
  const int step = unit_.dual_return && channels_ == 32 ? 2 : 1;  // blocks of a firing
  const int per_block = unit_.dual_return || channels_ == 32 ? 1 : 2;
  const double block_us = per_block * firing_us;
  const double expected_rate = 1e-6 * kTurn / unit_.sensor.scan_period_s;
  std::vector<Firing> firings;
  double rate = expected_rate;
  double time_us = 0.0;
  for (int block = 0; block < kBlocksOfPacket; block += step) {
    const int azimuth = azimuth_of(payload, block);
    double passed_us = block_us;
    if (block + step < kBlocksOfPacket) {
      const int advance = modulo_turn(azimuth_of(payload, block + step) - azimuth);
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

PulseReturn RobosenseDecoder::pulse_of(Bytes payload, const Firing& firing, int channel) const {
  const auto measured = [&](int block, int of_block) {
    const std::size_t at = block_at(block) + 4 + kReturnBytes * static_cast<std::size_t>(of_block);
    return PulseReturn{big_endian_16(payload, at), payload[at + 2]};
  };
  const int first = firing.first_channel + channel;
  const PulseReturn pulse = measured(firing.block, first);
  if (!unit_.dual_return) return pulse;
  // The second return stands in the next block, or of 16 channels behind the first ones.
  const PulseReturn other =
      channels_ == 32 ? measured(firing.block + 1, first) : measured(firing.block, 16 + channel);
  return kept_of(pulse, other, options_.kept_return);
}

void RobosenseDecoder::add_points(Bytes payload, const Firing& firing, double start_s) {
  const Timing& timing = timing_of(unit_.helios);
  for (int i = 0; i < channels_; ++i) {
    const PulseReturn pulse = pulse_of(payload, firing, i);
    if (pulse.distance == 0) continue;
    const Beam& beam = beams_[i];
    const double later_us = timing.channel_us * i;
    const double azimuth = firing.azimuth + firing.rate * later_us;
    const double lens_rad = azimuth * kHundredth_rad;
    const double beam_rad = (azimuth + beam.offset) * kHundredth_rad;
    const double range_m = timing.unit_m * pulse.distance;
    const double level_m = range_m * beam.cos_elevation;
    const double x_m = level_m * std::cos(beam_rad) + timing.lens_m * std::cos(lens_rad);
    const double y_m = -level_m * std::sin(beam_rad) - timing.lens_m * std::sin(lens_rad);
    scan_.points_m.push_back(Eigen::Vector3d(x_m, y_m, range_m * beam.sin_elevation).cast<float>());
    scan_.row.push_back(unit_.row_of_channel[i]);
    scan_.intensity.push_back(pulse.reflectivity);
    scan_.time_offset_s.push_back(static_cast<float>(start_s + 1e-6 * later_us));
  }
}

}  // namespace hqslam::recordings
