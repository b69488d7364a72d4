#include "points/azimuth_times.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "hqslam/core/angles.h"

namespace hqslam::recordings {

namespace {

/// A scan in the order of firing turns about once; one stored ring after ring once per ring.
constexpr double kMostTurns = 1.5;

/// Within half a turn of 0.
double wrapped(double angle_rad) { return angle_rad - kTwoPi * std::round(angle_rad / kTwoPi); }

/// Where the head stood, clockwise from the front.
double head_rad(const Scan& scan, std::size_t i, const SensorModel& sensor) {
  const double offset_rad = scan.row.empty() ? 0.0 : sensor.beam_azimuth_offset_rad[scan.row[i]];
  return offset_rad - std::atan2(scan.points_m[i].y(), scan.points_m[i].x());
}

}  // namespace

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
  // The head turned on while scans were missing.
  double turned = last_index_ ? turned_rad_ + kTwoPi * static_cast<double>(index - *last_index_ - 1)
                              : head_rad(scan, 0, sensor) + kTwoPi * scans_before;
  for (std::size_t i = 0; i < scan.points_m.size(); ++i) {
    turned += wrapped(head_rad(scan, i, sensor) - turned);
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
  turned_rad_ = turned;
  const double middle_rad = (*least + *most) / 2.0;
  const double s_per_rad = scan_period_s_ / kTwoPi;
  for (const double t : turned_rad) {
    scan.time_offset_s.push_back(static_cast<float>((t - middle_rad) * s_per_rad));
  }
  scan.stamp_s = (middle_rad - first_turned_rad_) * s_per_rad;
}

}  // namespace hqslam::recordings
