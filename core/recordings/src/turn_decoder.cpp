#include "turn_decoder.h"

#include <utility>

namespace hqslam::recordings {

namespace {

constexpr double kMostOfAScan = 0.75;
constexpr std::int64_t kSecond_ns = 1'000'000'000;

}  // namespace

double TurnDecoder::fire(int azimuth, std::int64_t time_ns, std::vector<Scan>& completed) {
  const int turned = modulo_turn(azimuth - cut_);
  if (!empty_ && turned < last_turned_ - kSmallestFall) {
    complete(completed);
    began_with_cut_ = true;
  } else if (!empty_ && time_ns - first_ns_ > kSecond_ns) {
    ++partial_scans_;  // the head stands still: no turn takes so long
    scan_ = {};
    empty_ = true;
    began_with_cut_ = false;
  }
  if (empty_) {
    first_turned_ = turned;
    first_ns_ = time_ns;
    empty_ = false;
  }
  last_turned_ = turned;
  last_ns_ = time_ns;
  return 1e-9 * static_cast<double>(time_ns - first_ns_);
}

/// Ends the scan. What began in the middle of a turn is one only if little of it is missing.
void TurnDecoder::complete(std::vector<Scan>& completed) {
  if (empty_) return;
  const std::size_t points = scan_.points_m.size();  // the next scan will have about as many
  const double seen_deg = 0.01 * (last_turned_ - first_turned_);
  if (!began_with_cut_ && seen_deg < kMostOfAScan * field_of_view_deg_) {
    ++partial_scans_;
  } else {
    const std::int64_t middle_ns = (last_ns_ - first_ns_) / 2;
    const auto middle_s = static_cast<float>(1e-9 * static_cast<double>(middle_ns));
    for (float& offset_s : scan_.time_offset_s) offset_s -= middle_s;
    scan_.stamp_s = 1e-9 * static_cast<double>(first_ns_ + middle_ns);
    completed.push_back(std::move(scan_));
  }
  scan_ = std::exchange(spare_, {});
  scan_.points_m.reserve(points);
  scan_.row.reserve(points);
  scan_.time_offset_s.reserve(points);
  scan_.intensity.reserve(points);
  empty_ = true;
}

void TurnDecoder::reuse(Scan scan) {
  scan.stamp_s = 0.0;
  scan.points_m.clear();
  scan.row.clear();
  scan.time_offset_s.clear();
  scan.intensity.clear();
  spare_ = std::move(scan);
}

void TurnDecoder::finish(std::vector<Scan>& completed) {
  began_with_cut_ = false;
  complete(completed);
}

}  // namespace hqslam::recordings
