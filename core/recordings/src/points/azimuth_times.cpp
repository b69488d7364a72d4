#include "points/azimuth_times.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "hqslam/core/angles.h"

namespace hqslam::recordings {

namespace {

/// A scan in the order of firing turns about once; one stored ring after ring once per ring.
constexpr double kMostTurns = 1.5;
/// Where clouds are parts of a turn, each is at least this long; the first points of cropped scans,
/// and of turns of 364 degrees, are from where the last scan began by less.
constexpr double kLeastPart_rad = kTwoPi / 8.0;
/// Beams with azimuth offsets and near things fall back by less from point to point; farther back
/// is ahead, across a part of the turn that was cropped.
constexpr double kMostBack_rad = kTwoPi / 4.0;

/// Within half a turn of 0.
double wrapped(double angle_rad) { return angle_rad - kTwoPi * std::round(angle_rad / kTwoPi); }

/// Where the head stood, clockwise from the front.
double head_rad(const Scan& scan, std::size_t i, const SensorModel& sensor) {
  const double offset_rad = scan.row.empty() ? 0.0 : sensor.beam_azimuth_offset_rad[scan.row[i]];
  return offset_rad - std::atan2(scan.points_m[i].y(), scan.points_m[i].x());
}

}  // namespace

double AzimuthTimes::turned_at_begin(double first_rad, std::size_t index) const {
  if (!last_index_) return first_rad + kTwoPi * static_cast<double>(index - *first_index_);
  const auto turns = static_cast<double>(index - *last_index_);
  const double a_turn_later_rad = begin_rad_ + kTwoPi * turns;
  const double on_from_end_rad = end_rad_ + kTwoPi * (turns - 1.0);  // it turned in missing scans
  const double later_rad = wrapped(first_rad - a_turn_later_rad);
  const double on_rad = wrapped(first_rad - on_from_end_rad);
  const bool is_part = std::abs(later_rad) - std::abs(on_rad) > kLeastPart_rad;
  return is_part ? on_from_end_rad + on_rad : a_turn_later_rad + later_rad;
}

void AzimuthTimes::set(Scan& scan, const SensorModel& sensor, std::size_t index) {
  if (!first_index_) first_index_ = index;
  const auto scans_before = static_cast<double>(index - *first_index_);
  scan.time_offset_s.clear();
  if (scan.points_m.empty()) {
    scan.stamp_s = (scans_before + 0.5) * scan_period_s_;
    return;
  }
  std::vector<double> turned_rad;
  turned_rad.reserve(scan.points_m.size());
  double turned = turned_at_begin(head_rad(scan, 0, sensor), index);
  for (std::size_t i = 0; i < scan.points_m.size(); ++i) {
    const double step_rad = wrapped(head_rad(scan, i, sensor) - turned);
    turned += step_rad < -kMostBack_rad ? step_rad + kTwoPi : step_rad;
    turned_rad.push_back(turned);
  }
  const auto [least, most] = std::ranges::minmax_element(turned_rad);
  if (*most - *least > kMostTurns * kTwoPi) {
    for (std::size_t i = 0; i < turned_rad.size(); ++i) {
      const double from_back = wrapped(head_rad(scan, i, sensor)) / kTwoPi;  // -1/2 .. 1/2
      scan.time_offset_s.push_back(static_cast<float>(from_back * scan_period_s_));
    }
    scan.stamp_s = (scans_before + 0.5) * scan_period_s_;
    return;
  }
  if (!last_index_) first_turned_rad_ = head_rad(scan, 0, sensor);
  last_index_ = index;
  begin_rad_ = turned_rad.front();
  end_rad_ = turned_rad.back();
  const double middle_rad = (*least + *most) / 2.0;
  const double s_per_rad = scan_period_s_ / kTwoPi;
  for (const double t : turned_rad) {
    scan.time_offset_s.push_back(static_cast<float>((t - middle_rad) * s_per_rad));
  }
  scan.stamp_s = (middle_rad - first_turned_rad_) * s_per_rad;
}

}  // namespace hqslam::recordings
