#include <algorithm>
#include <cmath>

#include "hqslam/core/error.h"
#include "hqslam/core/median.h"
#include "packets/velodyne_tables.h"

namespace hqslam::recordings {

namespace {

constexpr std::size_t kMaxSpacings = 20000;
/// Longer pauses are no spacing of packets, and no turn can be counted on over them.
constexpr std::int64_t kMaxSpacing_us = 100'000;
constexpr double kSpacingTolerance = 0.03;
constexpr int kDegreesOfTurn = 360;
/// A head's azimuth may fall back by this much, hundredths of a degree.
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

}  // namespace

void VelodyneProbe::add(const Packet& packet) {
  const Bytes payload = packet.payload;
  if (!is_velodyne_packet(payload)) return;
  ++packets_;
  if (has_pairs(payload)) ++with_pairs_;
  ++products_[payload[kProductAt]];
  const int blocks = used_blocks(payload);
  for (int i = 0; i < blocks; ++i) {
    ++banks_[bank_of(block_flag(payload, i))];
    const int azimuth = block_azimuth(payload, i);
    seen_[azimuth * kDegreesOfTurn / kTurn] = true;
    const int jump = (azimuth - last_block_azimuth_ + kTurn) % kTurn;
    if (last_block_azimuth_ >= 0 && jump < kTurn - kTremble) {
      largest_jump_ = std::max(largest_jump_, jump);
    }
    last_block_azimuth_ = azimuth;
  }
  const std::int64_t now_us = little_endian<std::uint32_t>(payload, kTimeAt);
  const int azimuth = block_azimuth(payload, 0);
  const std::int64_t spacing_us = now_us - last_us_;
  if (last_us_ >= 0 && spacing_us > 0 && spacing_us < kMaxSpacing_us &&
      spacings_us_.size() < kMaxSpacings) {
    spacings_us_.push_back(spacing_us);
    advances_.push_back((azimuth - last_azimuth_ + kTurn) % kTurn);
  }
  last_us_ = now_us;
  last_azimuth_ = azimuth;
}

std::uint8_t VelodyneProbe::factory_byte() const {
  return std::ranges::max_element(products_, {}, [](auto& count) { return count.second; })->first;
}

std::optional<VelodyneModel> VelodyneProbe::model_by_spacing(double spacing_us, bool dual) const {
  for (const VelodyneModel model : kVelodyneModels) {
    const VelodyneTiming& of = timing(model);
    const double expected_us = dual ? of.packet_us_dual : of.packet_us_single;
    if (std::abs(spacing_us - expected_us) < kSpacingTolerance * expected_us) return model;
  }
  return std::nullopt;
}

void VelodyneProbe::set_period(VelodyneStream& stream) const {
  double advance = 0.0;
  double time_us = 0.0;
  for (std::size_t i = 0; i < spacings_us_.size(); ++i) {
    if (static_cast<double>(spacings_us_[i]) > 1.5 * stream.packet_spacing_us) continue;
    advance += advances_[i];
    time_us += static_cast<double>(spacings_us_[i]);
  }
  // A head that stands still, or turns faster than any sensor's, gives no period.
  const double period_s = advance > 0.0 ? 1e-6 * time_us * kTurn / advance : 0.0;
  if (period_s > 0.01 && period_s < 1.0) stream.scan_period_s = period_s;
}

/// The longest run of directions in which nothing was measured, around the circle.
void VelodyneProbe::set_field_of_view(VelodyneStream& stream) const {
  int longest = 0;
  int longest_end = 0;
  int run = 0;
  for (int bin = 0; bin < 2 * kDegreesOfTurn; ++bin) {
    run = seen_[bin % kDegreesOfTurn] ? 0 : run + 1;
    if (run > longest && run <= kDegreesOfTurn) {
      longest = run;
      longest_end = bin + 1;
    }
  }
  // What was not reached yet looks the same: the head must have been seen to jump over it.
  if (longest < kSmallestBlindAngle_deg || largest_jump_ < 100 * (longest - 2)) return;
  stream.field_of_view_deg = kDegreesOfTurn - longest;
  stream.cut_azimuth_deg = (longest_end - longest / 2 + kDegreesOfTurn) % kDegreesOfTurn;
}

std::optional<VelodyneStream> VelodyneProbe::result(std::optional<VelodyneModel> otherwise) const {
  if (packets_ == 0) return std::nullopt;
  VelodyneStream stream;
  stream.dual_return = 2 * with_pairs_ > packets_;
  stream.factory_byte = factory_byte();
  for (const VelodyneModel model : kVelodyneModels) {
    if (timing(model).product == stream.factory_byte) stream.factory_model = model;
  }
  if (!spacings_us_.empty()) {
    stream.packet_spacing_us = static_cast<double>(median(spacings_us_));
  }
  const bool four_banks = 10 * banks_[2] > banks_[0];
  const bool two_banks = 2 * banks_[1] > banks_[0] && !four_banks;
  const auto by_spacing = model_by_spacing(stream.packet_spacing_us, stream.dual_return);
  const auto model = four_banks             ? std::optional(VelodyneModel::kVls128)
                     : two_banks            ? VelodyneModel::kHdl64e
                     : by_spacing           ? by_spacing
                     : stream.factory_model ? stream.factory_model
                                            : otherwise;
  if (!model) return std::nullopt;
  stream.model = *model;
  set_period(stream);
  set_field_of_view(stream);
  return stream;
}

}  // namespace hqslam::recordings
