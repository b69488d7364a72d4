#include "front_end/scan_check.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "hqslam/core/error.h"

namespace hqslam::slam {

namespace {

void check_size(const OrganizedCloud& cloud, const SensorModel& sensor) {
  if (cloud.rows != sensor.rows() || cloud.columns != sensor.columns) {
    throw Error(
        "scan of {}x{} pixels does not fit sensor '{}' of {}x{}: name the sensor that recorded it",
        cloud.rows, cloud.columns, sensor.name, sensor.rows(), sensor.columns);
  }
  const std::size_t pixels = static_cast<std::size_t>(cloud.rows) * cloud.columns;
  const std::size_t times = cloud.time_offset_s.size();
  const std::size_t intensities = cloud.intensity.size();
  if (intensities != 0 && intensities != pixels) {
    throw Error("scan of {}x{} pixels has {} intensities: give each pixel its own, or none at all",
                cloud.rows, cloud.columns, intensities);
  }
  if (cloud.points_m.size() != pixels || cloud.range_m.size() != pixels ||
      (times != 0 && times != pixels)) {
    throw Error(
        "scan of {}x{} pixels has {} points, {} ranges and {} capture times: give each pixel its "
        "own, or no times at all",
        cloud.rows, cloud.columns, cloud.points_m.size(), cloud.range_m.size(), times);
  }
}

/// Beyond it a double no longer tells the columns of a scan apart: such stamps have another unit.
constexpr double kMaxStamp_s = 1e11;

void check_stamp(double stamp_s) {
  if (!(std::abs(stamp_s) <= kMaxStamp_s)) {
    throw Error("stamp of a scan is {}, expected a time within +-{} s: give stamps in seconds",
                stamp_s, kMaxStamp_s);
  }
}

/// Offsets may reach so far from the stamp, in scan periods: half a period where the sensor turns
/// as its model says.
constexpr double kMaxOffset_periods = 1.0;
/// Offsets that span so much of a period are around its middle, if they are counted from there,
/// with less than kMaxMiddle_periods to spare.
constexpr double kWholeScan_periods = 0.6;
constexpr double kMaxMiddle_periods = 0.3;

/// The capture times of the returns must be offsets from the scan's stamp, its middle, in seconds.
void check_times(const OrganizedCloud& cloud, const SensorModel& sensor) {
  if (cloud.time_offset_s.empty()) return;
  double first_s = std::numeric_limits<double>::infinity();
  double last_s = -first_s;
  std::int64_t not_finite = 0;
  for (std::size_t pixel = 0; pixel < cloud.range_m.size(); ++pixel) {
    const double offset_s = cloud.time_offset_s[pixel];
    if (!(cloud.range_m[pixel] > 0.0F)) continue;
    if (!std::isfinite(offset_s)) {
      ++not_finite;
      continue;
    }
    first_s = std::min(first_s, offset_s);
    last_s = std::max(last_s, offset_s);
  }
  if (first_s > last_s && not_finite > 0) {
    throw ScanError(
        "none of the {} capture times of a scan's returns is finite: give each its own, or no "
        "times at all",
        not_finite);
  }
  if (first_s > last_s) return;
  const double period_s = sensor.scan_period_s;
  const bool too_far = std::max(-first_s, last_s) > kMaxOffset_periods * period_s;
  const bool off_the_middle = last_s - first_s > kWholeScan_periods * period_s &&
                              std::abs(first_s + last_s) / 2.0 > kMaxMiddle_periods * period_s;
  if (!too_far && !off_the_middle) return;
  throw ScanError(
      "capture times of a scan reach from {:.6g} to {:.6g} s after its stamp, expected about "
      "{:.3g} to {:.3g} s: give them in seconds, counted from the middle of the scan, and give "
      "that as the stamp",
      first_s, last_s, -period_s / 2.0, period_s / 2.0);
}

/// Whether a pixel holds what it should: no return, or a finite point at a finite range and time.
bool is_sound(const OrganizedCloud& cloud, std::size_t pixel) {
  return cloud.range_m[pixel] == 0.0F ||
         (cloud.range_m[pixel] > 0.0F && std::isfinite(cloud.range_m[pixel]) &&
          cloud.points_m[pixel].allFinite() &&
          (cloud.time_offset_s.empty() || std::isfinite(cloud.time_offset_s[pixel])));
}

}  // namespace

void check(const OrganizedCloud& cloud, double stamp_s, const SensorModel& sensor) {
  check_size(cloud, sensor);
  check_stamp(stamp_s);
  check_times(cloud, sensor);
}

OrganizedCloud without_unsound(const OrganizedCloud& cloud) {
  OrganizedCloud result = cloud;
  for (std::size_t pixel = 0; pixel < cloud.range_m.size(); ++pixel) {
    if (!is_sound(cloud, pixel)) result.range_m[pixel] = 0.0F;
  }
  return result;
}

bool all_sound(const OrganizedCloud& cloud) {
  for (std::size_t pixel = 0; pixel < cloud.range_m.size(); ++pixel) {
    if (!is_sound(cloud, pixel)) return false;
  }
  return true;
}

}  // namespace hqslam::slam
