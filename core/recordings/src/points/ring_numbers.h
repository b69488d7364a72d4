#pragma once

#include <string>
#include <vector>

#include "hqslam/core/point_fields.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::recordings {

/// How the rings of a recording are numbered: first, first + step, ...; most drivers' are 0, 1,
/// ..., some begin with 1, and where beams were deleted the others keep their numbers.
struct RingNumbers {
  int first = 0;
  int step = 1;

  /// By the rings that have points, which rise.
  static RingNumbers of(const std::vector<int>& numbers);
  /// Counts the rings of a scan 0, 1, ...
  void count_from_0(std::vector<double>& rings) const;
};

/// How the rings of some scans are numbered, if they are this sensor's. Numbers that all are rows
/// of the sensor stay as they are; otherwise, of those that fit, the ones whose points are nearest
/// to the sensor's beams. Numbers that do not fit stay, too, and are refused scan by scan.
RingNumbers ring_numbers(const std::vector<RawPoints>& scans, const SensorModel& sensor);

/// The sensor with the rows alone that have beams, which must be evenly spaced ones of it: as where
/// an OS1-16 sends 64 rings, or every second beam was deleted. Nothing where there are others, or
/// all. beams_rad: elevations, highest first.
std::optional<RowSelection> rows_with_beams(const SensorModel& sensor,
                                            const std::vector<double>& beams_rad);

/// The selection that has all of these rows, which rise, and the fewest others; nothing for fewer
/// than 4, or if it is all rows.
std::optional<RowSelection> selection_of(const std::vector<int>& rows);

/// "rows 3, 7, ..., 63 of 64 have points: read as a sensor of these 16"
std::string selection_text(int rows, RowSelection selection);

}  // namespace hqslam::recordings
