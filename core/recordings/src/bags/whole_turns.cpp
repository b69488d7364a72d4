#include "bags/whole_turns.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "hqslam/core/angles.h"
#include "hqslam/core/median.h"

namespace hqslam::recordings {

namespace {

/// Smallest share of a turn that makes a scan.
constexpr double kNearlyWhole = 0.75;
/// Messages hold one turn, within what scans of 355 to 365 degrees and gaps between differ.
constexpr double kOneTurn = 0.1;
/// Messages last as long as the time from one to the next, and turns are as long as one another.
constexpr double kSameTime = 0.2;
constexpr double kSameTurn = 0.05;
constexpr std::size_t kFewestPointsOfTurn = 100;
/// More than in a turn of any LiDAR: the stamps stand.
constexpr std::size_t kMostPointsOfTurn = 2'000'000;

/// By how much the azimuth goes on from the first to the last point in time, over the time; nothing
/// for points without times.
std::optional<double> turn_s(const RawPoints& message, double period_s) {
  const auto times = usable_times(message.time, period_s);
  if (!times || message.scan.points_m.size() < kFewestPointsOfTurn) return std::nullopt;
  if (std::abs(times->duration_s / period_s - 1.0) > kSameTime) return std::nullopt;
  std::vector<std::size_t> order(times->offset_s.size());
  std::iota(order.begin(), order.end(), 0);
  std::erase_if(order, [&](std::size_t i) { return std::isnan(times->offset_s[i]); });
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return times->offset_s[i]; });
  double turned_rad = 0.0, before_rad = 0.0;
  for (const std::size_t i : order) {
    const Eigen::Vector3f& p = message.scan.points_m[i];
    const double azimuth_rad = std::atan2(p.y(), p.x());
    if (i != order.front()) turned_rad += std::remainder(azimuth_rad - before_rad, kTwoPi);
    before_rad = azimuth_rad;
  }
  return kTwoPi * times->duration_s / std::max(std::abs(turned_rad), 1e-6);
}

/// Appends what has been measured of point i.
void append(const Scan& from, std::size_t i, float offset_s, Scan& to) {
  to.points_m.push_back(from.points_m[i]);
  to.time_offset_s.push_back(offset_s);
  if (!from.row.empty()) to.row.push_back(from.row[i]);
  if (!from.intensity.empty()) to.intensity.push_back(from.intensity[i]);
  if (!from.confidence.empty()) to.confidence.push_back(from.confidence[i]);
}

}  // namespace

std::optional<double> turn_of_parts_s(const std::vector<RawPoints>& messages, double period_s) {
  std::vector<double> turns_s;
  for (const RawPoints& message : messages) {
    if (const auto turn = turn_s(message, period_s)) turns_s.push_back(*turn);
  }
  if (turns_s.empty() || 2 * turns_s.size() < messages.size()) return std::nullopt;
  const double middle_s = median(turns_s);
  const auto differ = std::ranges::count_if(
      turns_s, [&](double turn) { return std::abs(turn / middle_s - 1.0) > kSameTurn; });
  const bool one_turn = std::abs(period_s / middle_s - 1.0) < kOneTurn;
  if (one_turn || 4 * differ > std::ssize(turns_s) || !(middle_s > 0.02 && middle_s < 1.0)) {
    return std::nullopt;
  }
  return middle_s;
}

void WholeTurns::add(const Scan& part) {
  if (part.time_offset_s.empty()) return;
  const auto [first, last] = std::ranges::minmax_element(part.time_offset_s);
  const double first_s = part.stamp_s + *first;
  const double end_s = part.stamp_s + *last;
  const bool is_gap = std::abs(first_s - last_s_) > turn_s_;
  if (open_.points_m.empty() || is_gap || open_.points_m.size() > kMostPointsOfTurn) {
    finish();
    begin_s_ = first_s;
  }
  open_.invalid_points += part.invalid_points;
  for (std::size_t i = 0; i < part.points_m.size(); ++i) {
    const double offset_s = part.stamp_s - begin_s_ + double{part.time_offset_s[i]};
    append(part, i, static_cast<float>(offset_s), open_);
  }
  last_s_ = end_s;
  while (end_s - begin_s_ >= turn_s_) cut(begin_s_ + turn_s_);
}

/// What was measured before end_s is a scan.
void WholeTurns::cut(double end_s) {
  Scan scan, rest;
  const double middle_s = (begin_s_ + end_s) / 2.0;
  for (std::size_t i = 0; i < open_.points_m.size(); ++i) {
    const double time_s = begin_s_ + double{open_.time_offset_s[i]};
    const bool is_rest = time_s >= end_s;
    append(open_, i, static_cast<float>(time_s - (is_rest ? end_s : middle_s)),
           is_rest ? rest : scan);
  }
  scan.stamp_s = middle_s;
  scan.invalid_points = open_.invalid_points;
  if (!scan.points_m.empty()) whole_.push_back(std::move(scan));
  open_ = std::move(rest);
  begin_s_ = end_s;
}

void WholeTurns::finish() {
  if (!open_.points_m.empty() && last_s_ - begin_s_ >= kNearlyWhole * turn_s_) {
    cut(std::nextafter(std::max(last_s_, begin_s_ + turn_s_), HUGE_VAL));
  }
  open_ = {};
}

std::optional<Scan> WholeTurns::next() {
  if (whole_.empty()) return std::nullopt;
  Scan scan = std::move(whole_.front());
  whole_.erase(whole_.begin());
  return scan;
}

}  // namespace hqslam::recordings
