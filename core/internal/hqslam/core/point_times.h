#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/scan.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam {

/// The times of a scan's points as a file or a message has them.
struct PointTimeField {
  std::string name;
  bool whole_numbers = false;
  std::vector<double> values;
};

/// The same in seconds.
struct PointTimes {
  std::vector<float> offset_s;  ///< from the middle of the times
  double middle_s = 0.0;        ///< by the field's own zero
  /// Whether that zero is that of a clock rather than the scan's own.
  bool absolute = false;
};

/// Field -> seconds. The unit is that in which the times last about one turn of the sensor:
/// seconds, milli-, micro- or nanoseconds; where several would do, seconds for numbers with a
/// fraction and nanoseconds for whole ones. Nothing if all times are equal (a driver that fills in
/// 0). Throws Error if a time is not finite or if they last more than five quarters of a turn.
std::optional<PointTimes> point_times(const PointTimeField& field, double scan_period_s,
                                      const std::string& source);

/// Rows from the numbers of rings, one per point. Some drivers number them from the highest beam
/// (Ouster), some from the lowest (Velodyne): the correlation of ring and elevation tells, and rows
/// count from the highest either way. Rings that follow the elevation in neither way give no rows,
/// so that the elevation decides. Throws Error for a ring that the sensor does not have, and for at
/// most half of its rings whose points are not where its beams look; `source` and `field` stand for
/// it in messages.
std::vector<std::uint16_t> rows_from_rings(const std::vector<double>& ring, const Scan& scan,
                                           const SensorModel& sensor, const std::string& source,
                                           const std::string& field);

}  // namespace hqslam
