#pragma once

#include <string>

#include "hqslam/core/point_fields.h"
#include "hqslam/core/scan_source.h"

namespace hqslam::recordings {

/// Where a larger share of points or rows fits no pixel, the scan is from another sensor.
inline constexpr double kMaxForeignShare = 0.5;

// Points become a scan here, whichever file or message they come from:
//   RawPoints -> scan_of: times -> with_rows: rows -> recorded_scan: pixels

/// Determines the rows of points that are stored ring after ring from that order. Known rows stay;
/// where rows remain unknown, projection takes the beam nearest in elevation.
/// Throws Error unless the rings are those of the sensor; `source` stands for the scan in messages.
void set_rows_by_order(Scan& scan, const SensorModel& sensor, const std::string& source);

/// Points -> pixels of the sensor's image. Throws Error for points that cannot be the sensor's.
RecordedScan recorded_scan(const Scan& scan, const SensorModel& sensor, std::string name);

/// A warning where the points are not the sensor's pixels: "" unless most are nearer to another
/// beam than to that of their row (clouds in a vehicle's frame), or more than a quarter share a
/// pixel with a nearer one (too few columns).
std::string fit_warning(const RecordedScan& scan, const SensorModel& sensor);

}  // namespace hqslam::recordings
