#include "packets/turn_decoder.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "hqslam/core/projection.h"

namespace hqslam::recordings {

namespace {

constexpr double kMostOfAScan = 0.75;
/// After this share of a turn without packets the azimuth may be about what it was before.
constexpr double kWholeTurn = 0.99;
/// A head may tremble by some hundredths of a degree; more is a new turn.
constexpr int kSmallestFall = 200;
constexpr std::int64_t kSecond_ns = 1'000'000'000;
/// The gaps that two clocks measure differ by less.
constexpr double kMostApart_s = 0.5;

}  // namespace

PulseReturn kept_of(PulseReturn a, PulseReturn b, KeptReturn which) {
  if (a.distance == 0 || b.distance == 0) return a.distance == 0 ? b : a;
  if (which == KeptReturn::kLast) return a.distance < b.distance ? b : a;
  return a.reflectivity < b.reflectivity ? b : a;
}

std::optional<std::int64_t> date_ns(int year, Bytes month_to_second) {
  const Bytes& of = month_to_second;
  const std::chrono::year_month_day day{std::chrono::year{year}, std::chrono::month{of[0]},
                                        std::chrono::day{of[1]}};
  if (!day.ok() || of[2] > 23 || of[3] > 59 || of[4] > 60) return std::nullopt;
  const std::int64_t days = std::chrono::sys_days{day}.time_since_epoch().count();
  return kSecond_ns * (86400 * days + 3600 * of[2] + 60 * of[3] + of[4]);
}

double period_at(int turns_per_minute) {
  if (turns_per_minute <= 100 || turns_per_minute >= 3000) return 0.1;
  return 60.0 / (10.0 * std::round(turns_per_minute / 10.0));  // 599 or 601 are 600
}

bool TurnDecoder::take_time(std::int64_t sensor_ns, std::int64_t capture_ns, double scan_period_s,
                            int azimuth) {
  passed_s_ = 0.0;
  cuts_ = 0;
  const int turned = modulo_turn(azimuth - cut_);
  if (last_sensor_ns_) {
    const std::int64_t passed_ns = sensor_ns - *last_sensor_ns_;
    if (passed_ns <= 0 && passed_ns > -kSecond_ns) {
      ++counts_.late;
      return false;
    }
    const double passed_s = 1e-9 * static_cast<double>(passed_ns);
    const double recorded_s =
        1e-9 * (static_cast<double>(capture_ns) - static_cast<double>(last_capture_ns_));
    if (std::abs(passed_s - recorded_s) <= kMostApart_s) {  // otherwise a clock was set
      passed_s_ = passed_s;
      const double ahead = static_cast<double>(last_packet_turned_ - turned) / kTurn;
      cuts_ = std::llround(passed_s / scan_period_s + ahead);
      // At the end of the turn before, of each lost one, and no other time.
      lost_scans_ += std::max<std::int64_t>(0, cuts_ - 1);
    }
    if (passed_s >= kWholeTurn * scan_period_s || passed_s < 0.0) finish();
  }
  last_sensor_ns_ = sensor_ns;
  last_capture_ns_ = capture_ns;
  last_packet_turned_ = turned;
  return true;
}

std::int64_t TurnDecoder::recorded_ns(std::int64_t sensor_ns, std::int64_t capture_ns) {
  constexpr std::int64_t kFarthest_ns = 9'000'000'000 * kSecond_ns;  // a damaged file may hold more
  const std::int64_t time_ns =
      clock_.recorded_ns(sensor_ns, std::clamp(capture_ns, -kFarthest_ns, kFarthest_ns));
  if (clock_.was_set()) finish();
  return time_ns;
}

double TurnDecoder::fire(int azimuth, std::int64_t time_ns) {
  const int turned = modulo_turn(azimuth - cut_);
  if (!empty_ && turned < last_turned_ - kSmallestFall) {
    complete();
    began_with_cut_ = true;
  } else if (!empty_ && time_ns - first_ns_ > kSecond_ns) {
    ++partial_scans_;  // the head stands still: no turn takes a second
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
void TurnDecoder::complete() {
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
    completed_.push_back(std::move(scan_));
  }
  scan_ = std::exchange(spare_, {});
  scan_.points_m.reserve(points);
  scan_.row.reserve(points);
  scan_.time_offset_s.reserve(points);
  scan_.intensity.reserve(points);
  empty_ = true;
}

std::optional<RecordedScan> TurnDecoder::next() {
  if (completed_.empty()) return std::nullopt;
  Scan scan = std::move(completed_.front());
  completed_.erase(completed_.begin());
  ProjectedScan projected = project(scan, sensor_);
  RecordedScan result;
  result.name = fmt::format("{}[{}]", name_, taken_++);
  result.stamp_s = scan.stamp_s;
  result.cloud = std::move(projected.cloud);
  result.counts = projected.counts;
  scan.points_m.clear();  // its memory serves the next one
  scan.row.clear();
  scan.time_offset_s.clear();
  scan.intensity.clear();
  spare_ = std::move(scan);
  return result;
}

void TurnDecoder::finish() {
  began_with_cut_ = false;
  complete();
}

}  // namespace hqslam::recordings
