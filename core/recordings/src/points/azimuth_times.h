#pragma once

#include <cstddef>
#include <optional>

#include "hqslam/core/scan.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::recordings {

/// Times of points that were recorded without any, from the azimuth at which they were measured.
///
/// In:  scans as captured while the head turned, points in the order of their firing; a turn takes
///      scan_period_s. `index`, of the scan in its recording, rises; scans may be missing.
/// Out: time offset = (turns of the head up to the point) x scan_period_s, from the middle of the
///      scan's times. The turns are counted on from scan to scan, so a scan of 364 degrees takes
///      that much longer than one of 360; scans that are cropped to a part of the turn stay a turn
///      apart. stamp_s is the middle of a scan's times since the first point of the first scan.
///      Points that are stored ring after ring turn many times within a scan: such a scan begins at
///      the back, as an image does, and lasts one turn.
class AzimuthTimes {
 public:
  explicit AzimuthTimes(double scan_period_s) : scan_period_s_(scan_period_s) {}

  void set(Scan& scan, const SensorModel& sensor, std::size_t index);

 private:
  /// Where the head stood at the first point, with the turns before. A scan begins where the last
  /// one began, a turn later; only a part of a turn begins where the last one ended.
  double turned_at_begin(double first_rad, std::size_t index) const;

  double scan_period_s_;
  std::optional<std::size_t> first_index_;
  std::optional<std::size_t> last_index_;  ///< up to which turns were counted
  double begin_rad_ = 0.0;                 ///< of that scan, clockwise, since azimuth 0
  double end_rad_ = 0.0;
  double first_turned_rad_ = 0.0;
};

}  // namespace hqslam::recordings
