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

/// A warning where the sensor's image has too few columns: "" unless more than a quarter of the
/// points share a pixel with a nearer one.
std::string crowding_warning(const RecordedScan& scan);

}  // namespace hqslam::recordings
