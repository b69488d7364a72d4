#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "hqslam/core/error.h"
#include "velodyne_tables.h"

namespace hqslam::recordings {

namespace {

constexpr std::size_t kMaxSpacings = 20000;
/// Longer pauses are no spacing of packets, and no turn can be counted on over them.
constexpr std::int64_t kMaxSpacing_us = 100'000;
constexpr double kSpacingTolerance = 0.03;
constexpr int kBins = 360;
/// A head's azimuth may fall back by so much, hundredths of a degree.
constexpr int kTremble = 200;
/// A head that sees all around leaves no such gap, whatever was lost.
constexpr int kSmallestBlindAngle_deg = 10;

bool has_pairs(Bytes payload) {
  const int blocks = used_blocks(payload);
  for (int i = 0; i < blocks; i += 2) {
    if (block_flag(payload, i) != block_flag(payload, i + 1) ||
        block_azimuth(payload, i) != block_azimuth(payload, i + 1)) {
      return false;
    }
  }
  return true;
}

template <typename Value>
Value median(std::vector<Value> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

struct VelodyneProbe::State {
  std::int64_t packets = 0;
  std::int64_t with_pairs = 0;
  std::int64_t with_double_pairs = 0;  ///< as an HDL-64E with two returns sends them
  std::array<std::int64_t, 4> banks{};
  std::map<std::uint8_t, std::int64_t> products;
  std::vector<std::int64_t> spacings_us;
  std::vector<int> advances;  ///< of the azimuth, in hundredths of a degree, over the same times
  std::array<bool, kBins> seen{};
  std::int64_t last_us = -1;
  int last_azimuth = 0;
  int last_block_azimuth = -1;
  int largest_jump = 0;  ///< of the azimuth from block to block, hundredths of a degree

  std::optional<VelodyneModel> factory_model() const;
  std::optional<VelodyneModel> model_by_spacing(double spacing_us, bool dual) const;
  void set_period(VelodyneStream& stream) const;
  void set_field_of_view(VelodyneStream& stream) const;
};

VelodyneProbe::VelodyneProbe() : state_(std::make_unique<State>()) {}
VelodyneProbe::~VelodyneProbe() = default;

void VelodyneProbe::add(const Packet& packet) {
  const Bytes payload = packet.payload;
  if (!is_velodyne_packet(payload)) return;
  State& state = *state_;
  ++state.packets;
  if (has_pairs(payload)) ++state.with_pairs;
  if (block_azimuth(payload, 0) == block_azimuth(payload, 2) &&
      block_azimuth(payload, 4) == block_azimuth(payload, 6)) {
    ++state.with_double_pairs;
  }
  ++state.products[payload[kProductAt]];
  const int blocks = used_blocks(payload);
  for (int i = 0; i < blocks; ++i) {
    ++state.banks[bank_of(block_flag(payload, i))];
    const int azimuth = block_azimuth(payload, i);
    state.seen[azimuth * kBins / 36000] = true;
    const int jump = (azimuth - state.last_block_azimuth + 36000) % 36000;
    if (state.last_block_azimuth >= 0 && jump < 36000 - kTremble) {
      state.largest_jump = std::max(state.largest_jump, jump);
    }
    state.last_block_azimuth = azimuth;
  }
  const std::int64_t now_us = little_endian<std::uint32_t>(payload, kTimeAt);
  const int azimuth = block_azimuth(payload, 0);
  const std::int64_t spacing_us = now_us - state.last_us;
  if (state.last_us >= 0 && spacing_us > 0 && spacing_us < kMaxSpacing_us &&
      state.spacings_us.size() < kMaxSpacings) {
    state.spacings_us.push_back(spacing_us);
    state.advances.push_back((azimuth - state.last_azimuth + 36000) % 36000);
  }
  state.last_us = now_us;
  state.last_azimuth = azimuth;
}

std::optional<VelodyneModel> VelodyneProbe::State::factory_model() const {
  const auto most = std::max_element(products.begin(), products.end(),
                                     [](auto& a, auto& b) { return a.second < b.second; });
  for (const VelodyneModel model : kVelodyneModels) {
    if (timing(model).product == most->first) return model;
  }
  return std::nullopt;
}

std::optional<VelodyneModel> VelodyneProbe::State::model_by_spacing(double spacing_us,
                                                                    bool dual) const {
  for (const VelodyneModel model : kVelodyneModels) {
    const VelodyneTiming& of = timing(model);
    const double expected_us = dual ? of.packet_us_dual : of.packet_us_single;
    if (std::abs(spacing_us - expected_us) < kSpacingTolerance * expected_us) return model;
  }
  return std::nullopt;
}

void VelodyneProbe::State::set_period(VelodyneStream& stream) const {
  double advance = 0.0;
  double time_us = 0.0;
  for (std::size_t i = 0; i < spacings_us.size(); ++i) {
    if (static_cast<double>(spacings_us[i]) > 1.5 * stream.packet_spacing_us) continue;
    advance += advances[i];
    time_us += static_cast<double>(spacings_us[i]);
  }
  // A head that stands still or turns beyond reason says nothing about a period.
  const double period_s = advance > 0.0 ? 1e-6 * time_us * 36000.0 / advance : 0.0;
  if (period_s > 0.01 && period_s < 1.0) stream.scan_period_s = period_s;
}

/// The longest run of directions in which nothing was measured, around the circle.
void VelodyneProbe::State::set_field_of_view(VelodyneStream& stream) const {
  int longest = 0;
  int longest_end = 0;
  int run = 0;
  for (int bin = 0; bin < 2 * kBins; ++bin) {
    run = seen[bin % kBins] ? 0 : run + 1;
    if (run > longest && run <= kBins) {
      longest = run;
      longest_end = bin + 1;
    }
  }
  // What was not reached yet looks the same: the head must have been seen to jump over it.
  if (longest < kSmallestBlindAngle_deg || largest_jump < 100 * (longest - 2)) return;
  stream.field_of_view_deg = kBins - longest;
  stream.cut_azimuth_deg = (longest_end - longest / 2 + kBins) % kBins;
}

std::optional<VelodyneStream> VelodyneProbe::result(std::optional<VelodyneModel> otherwise) const {
  const State& state = *state_;
  if (state.packets == 0) return std::nullopt;
  VelodyneStream stream;
  stream.dual_return = 2 * state.with_pairs > state.packets;
  stream.factory_model = state.factory_model();
  if (!state.spacings_us.empty()) {
    stream.packet_spacing_us = static_cast<double>(median(state.spacings_us));
  }
  const bool four_banks = 10 * state.banks[2] > state.banks[0];
  const bool two_banks = 2 * state.banks[1] > state.banks[0] && !four_banks;
  const auto by_spacing = state.model_by_spacing(stream.packet_spacing_us, stream.dual_return);
  if (four_banks) {
    stream.model = VelodyneModel::kVls128;
  } else if (two_banks && 2 * state.with_double_pairs > state.packets) {
    throw Error(
        "expected packets of an HDL-64E with one return, found two; set the sensor to one, or "
        "give its scans as point clouds");
  } else if (two_banks) {
    stream.model = VelodyneModel::kHdl64e;
  } else if (by_spacing) {
    stream.model = *by_spacing;
  } else if (stream.factory_model) {
    stream.model = *stream.factory_model;
  } else if (otherwise) {
    stream.model = *otherwise;
  } else {
    return std::nullopt;
  }
  state.set_period(stream);
  state.set_field_of_view(stream);
  return stream;
}

}  // namespace hqslam::recordings
