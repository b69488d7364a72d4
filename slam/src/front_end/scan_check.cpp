#include "front_end/scan_check.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "hqslam/core/error.h"

namespace hqslam::slam {

namespace {

/// Beyond it a double cannot resolve the columns of a scan: such stamps have another unit.
constexpr double kMaxStamp_s = 1e11;

void check_stamp(double stamp_s) {
  if (!(std::abs(stamp_s) <= kMaxStamp_s)) {
    throw Error("expected a stamp within +-{} s, found {}: give stamps in seconds", kMaxStamp_s,
                stamp_s);
  }
}

/// Largest offset from the stamp, in scan periods; half a period if the sensor turns at the rate of
/// its model.
constexpr double kMaxOffset_periods = 1.0;
/// Offsets that span at least this share of a period must be centred on the stamp to within
/// kMaxMiddle_periods.
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
        "expected finite capture times, found none among those of {} returns of a scan: give each "
        "its own, or no times at all",
        not_finite);
  }
  if (first_s > last_s) return;
  const double period_s = sensor.scan_period_s;
  const bool too_far = std::max(-first_s, last_s) > kMaxOffset_periods * period_s;
  const bool off_the_middle = last_s - first_s > kWholeScan_periods * period_s &&
                              std::abs(first_s + last_s) / 2.0 > kMaxMiddle_periods * period_s;
  if (!too_far && !off_the_middle) return;
  throw ScanError(
      "expected capture times of about {:.3g} to {:.3g} s from a scan's stamp, found {:.6g} to "
      "{:.6g} s: give seconds from the middle of the scan, and the time of that as its stamp",
      -period_s / 2.0, period_s / 2.0, first_s, last_s);
}

}  // namespace

void check_shape(const OrganizedCloud& cloud) {
  const auto pixels =
      static_cast<std::size_t>(std::max(cloud.rows, 0)) * std::max(cloud.columns, 0);
  const auto fits = [&](const auto& values) { return values.empty() || values.size() == pixels; };
  if (cloud.points_m.size() == pixels && cloud.range_m.size() == pixels &&
      fits(cloud.time_offset_s) && fits(cloud.confidence) && fits(cloud.intensity)) {
    return;
  }
  throw Error(
      "scan of {}x{} pixels has {} points, {} ranges, {} capture times, {} confidences and {} "
      "intensities: give each pixel its own, of the last three or none",
      cloud.rows, cloud.columns, cloud.points_m.size(), cloud.range_m.size(),
      cloud.time_offset_s.size(), cloud.confidence.size(), cloud.intensity.size());
}

bool is_sound(const OrganizedCloud& cloud, std::size_t pixel) {
  return cloud.range_m[pixel] == 0.0F ||
         (cloud.range_m[pixel] > 0.0F && std::isfinite(cloud.range_m[pixel]) &&
          cloud.points_m[pixel].allFinite() &&
          (cloud.time_offset_s.empty() || std::isfinite(cloud.time_offset_s[pixel])));
}

void check(const OrganizedCloud& cloud, double stamp_s, const SensorModel& sensor) {
  if (cloud.rows != sensor.rows() || cloud.columns != sensor.columns) {
    throw Error(
        "scan of {}x{} pixels does not fit sensor '{}' of {}x{}: name the sensor that recorded it",
        cloud.rows, cloud.columns, sensor.name, sensor.rows(), sensor.columns);
  }
  check_shape(cloud);
  check_stamp(stamp_s);
  check_times(cloud, sensor);
}

std::optional<OrganizedCloud> without_unsound(const OrganizedCloud& cloud) {
  std::optional<OrganizedCloud> result;
  for (std::size_t pixel = 0; pixel < cloud.range_m.size(); ++pixel) {
    if (is_sound(cloud, pixel)) continue;
    if (!result) result = cloud;
    result->range_m[pixel] = 0.0F;
  }
  return result;
}

}  // namespace hqslam::slam
