#include "packets/velodyne_decoder.h"

#include <algorithm>
#include <cmath>
#include <numbers>

// A point of a Velodyne packet.
//
// In:  block i of a packet: azimuth a_i (hundredths of a degree, clockwise from the front) at the
//      time t_i of its first firing; channel c: distance, of the laser that fires dt_c later.
// Out: a = a_i + dt_c (a_j - a_i) / (t_j - t_i) + offset of the laser, j the next block of another
//      firing (the last block takes the rate of the one before);
//      x = h cos a, y = -h sin a, z = d sin e with h = d cos e; time t_i + dt_c.
// A jump of the azimuth that no head makes between two blocks is the part of the circle that the
// sensor does not look at: the blocks behind it fired as much later as the head took to pass it.

namespace hqslam::recordings {

namespace {

constexpr double kHalfTurn = kTurn / 2.0;
constexpr std::int64_t kSecond_us = 1'000'000;
/// Largest difference, in seconds, of one gap by two clocks: packets are recorded late.
constexpr double kMostApart = 0.5;
/// No recording has a longer gap.
constexpr double kMostHours = 1000.0;

/// Cosine and sine of hundredths of a degree.
struct Directions {
  std::vector<float> cosine, sine;
  Directions() {
    for (int i = 0; i < kTurn; ++i) {
      cosine.push_back(static_cast<float>(std::cos(i * std::numbers::pi / kHalfTurn)));
      sine.push_back(static_cast<float>(std::sin(i * std::numbers::pi / kHalfTurn)));
    }
  }
};

const Directions& directions() {
  static const Directions table;
  return table;
}

PulseReturn measurement(Bytes payload, int block_index, int channel) {
  const std::size_t at = kBlockBytes * static_cast<std::size_t>(block_index) + 4 +
                         3 * static_cast<std::size_t>(channel);
  return {little_endian<std::uint16_t>(payload, at), payload[at + 2]};
}

}  // namespace

VelodyneDecoder::VelodyneDecoder(const VelodyneStream& stream, const SensorModel& sensor,
                                 const DecoderOptions& options, std::string name)
    : TurnDecoder(sensor, std::move(name),
                  modulo_turn(static_cast<int>(std::lround(100.0 * stream.cut_azimuth_deg))),
                  stream.field_of_view_deg, options),
      stream_(stream),
      timing_(timing(stream.model)),
      channels_(channels_of(stream, sensor)) {
  rate_ = expected_rate();
}

/// The packet's time without the sensor's restart every hour. For steps of more than a second the
/// recorder's clock gives the number of hours, unless one of the two clocks was set.
std::int64_t VelodyneDecoder::continued_us(const Packet& packet) const {
  const std::int64_t now_us = little_endian<std::uint32_t>(packet.payload, kTimeAt);
  if (!sensor_us_) return now_us;
  const double passed_us = std::remainder(static_cast<double>(now_us - *sensor_us_), kHour_us);
  const std::int64_t time_us = *sensor_us_ + std::llround(passed_us);
  if (std::abs(passed_us) < kSecond_us) return time_us;
  const double recorded_us =
      1e-3 * (static_cast<double>(packet.capture_time_ns) - static_cast<double>(last_capture_ns_));
  const double hours = std::round((recorded_us - passed_us) / kHour_us);
  const double apart_us = recorded_us - passed_us - hours * kHour_us;
  const bool agree =
      std::abs(apart_us) < kMostApart * kSecond_us && hours >= 0.0 && hours < kMostHours;
  return agree ? time_us + static_cast<std::int64_t>(hours) * kHour_us : time_us;
}

/// Packets that never came between the last one and this one.
void VelodyneDecoder::count_lost() {
  const double spacing_us = stream_.dual_return ? timing_.packet_us_dual : timing_.packet_us_single;
  const double blind_s = (1.0 - stream_.field_of_view_deg / 360.0) * stream_.scan_period_s;
  const double sent_us = 1e6 * (passed_s_ - static_cast<double>(cuts_) * blind_s);
  counts_.lost += std::max<std::int64_t>(0, std::llround(sent_us / spacing_us) - 1);
}

/// The firings of a packet with their azimuths and times.
void VelodyneDecoder::read_firings(Bytes payload) {
  firings_.clear();
  const int step = stream_.dual_return ? 2 : 1;
  const bool banks = timing_.lasers > kChannels;
  const int blocks = used_blocks(payload);
  int sequence = 0;
  for (int i = 0; i < blocks; i += step) {
    const int pulse = i / step;
    Firing firing;
    firing.block = i;
    firing.bank = banks ? bank_of(block_flag(payload, i)) : 0;
    firing.azimuth = block_azimuth(payload, i);
    if (banks) {
      if (!firings_.empty() && firing.bank <= firings_.back().bank) ++sequence;
      firing.time_us = sequence * timing_.firing_us;
    } else {
      firing.time_us = pulse * timing_.block_firings * timing_.firing_us;
    }
    firings_.push_back(firing);
  }
  if (banks) {  // the packet's time is that of its first firing, whichever laser's that is
    const std::vector<VelodyneChannel>& first = channels_[firings_.front().bank];
    const double first_us = first.empty() ? 0.0 : first.front().time_us;
    for (Firing& firing : firings_) firing.time_us -= first_us;
  }
  set_rates();
}

void VelodyneDecoder::set_rates() {
  double blind_us = 0.0;
  for (std::size_t i = 0; i < firings_.size(); ++i) {
    const double own_us = firings_[i].time_us;
    std::size_t next = i + 1;
    while (next < firings_.size() && firings_[next].time_us == own_us) ++next;
    double passed_us = 0.0;
    if (next < firings_.size()) {
      const double step_us = firings_[next].time_us - own_us;
      const int advance = modulo_turn(firings_[next].azimuth - firings_[i].azimuth);
      if (advance <= 100 + 3.0 * expected_rate() * step_us) {
        rate_ = advance / step_us;
      } else if (next == i + 1 && advance < kTurn / 2 + kTurn / 3) {
        passed_us = std::max(0.0, advance / expected_rate() - step_us);
      }
    }
    firings_[i].rate = rate_;
    firings_[i].time_us = own_us + blind_us;
    blind_us += passed_us;
  }
}

void VelodyneDecoder::add(const Packet& packet) {
  if (!is_velodyne_packet(packet.payload)) {
    ++counts_.foreign;
    return;
  }
  const std::int64_t time_us = continued_us(packet);
  const int azimuth = block_azimuth(packet.payload, 0);
  if (!take_time(1000 * time_us, packet.capture_time_ns, stream_.scan_period_s, azimuth)) return;
  sensor_us_ = time_us;
  ++counts_.used;
  count_lost();
  const std::int64_t packet_ns = recorded_ns(1000 * time_us, packet.capture_time_ns);
  read_firings(packet.payload);
  for (const Firing& firing : firings_) {
    const std::int64_t firing_ns = packet_ns + std::llround(1e3 * firing.time_us);
    const double start_s = fire(firing.azimuth, firing_ns);
    if (options_.with_points) add_points(firing, packet.payload, start_s);
  }
}

/// `start_s`: of the firing after the scan's first one.
void VelodyneDecoder::add_points(const Firing& firing, Bytes payload, double start_s) {
  const Directions& table = directions();
  const auto unit_m = static_cast<float>(timing_.distance_unit_m);
  const int channels = static_cast<int>(channels_[firing.bank].size());
  for (int c = 0; c < channels; ++c) {
    PulseReturn measured = measurement(payload, firing.block, c);
    // The first block of a pair has the last return, which is the farther one, the second block the
    // strongest, or the second strongest where the last one is the strongest.
    if (stream_.dual_return) {
      measured = kept_of(measurement(payload, firing.block + 1, c), measured, options_.kept_return);
    }
    if (measured.distance == 0) continue;
    const VelodyneChannel& channel = channels_[firing.bank][c];
    const double azimuth = firing.azimuth + firing.rate * channel.azimuth_us + channel.clockwise;
    const double whole = std::floor(azimuth);
    const int entry = modulo_turn(static_cast<int>(whole));
    const auto rest = static_cast<float>((azimuth - whole) * (std::numbers::pi / kHalfTurn));
    const float cosine = table.cosine[entry] - rest * table.sine[entry];
    const float sine = table.sine[entry] + rest * table.cosine[entry];
    const float distance_m = unit_m * static_cast<float>(measured.distance);
    const float horizontal_m = distance_m * channel.cos_elevation;
    // Not -horizontal_m * sine: a y of -0 behind the sensor would be in the last column.
    scan_.points_m.emplace_back(horizontal_m * cosine, 0.0F - horizontal_m * sine,
                                distance_m * channel.sin_elevation);
    scan_.row.push_back(channel.row);
    scan_.intensity.push_back(measured.reflectivity);
    scan_.time_offset_s.push_back(static_cast<float>(start_s + 1e-6 * channel.time_us));
  }
}

}  // namespace hqslam::recordings
