#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/point_fields.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::recordings {

struct FoundSensor {
  SensorModel sensor;  ///< a preset where all beams are one's, else without azimuth offsets
  std::vector<double> beam_elevation_rad;  ///< measured in the points, highest first; or empty
  std::string note;      ///< how it was found and how well it fits, for one line; or ""
  bool is_found = true;  ///< in the points; otherwise stated
};

/// Determines the sensor of a recording from the points of its scans; sensor_finder.cpp has the
/// method. One scan that is of another kind than the others may be among four and more.
/// scan_period_s: the recording's, 0.1 s where unknown. Throws Error where beams are not
/// clearly apart or scans contradict each other; `source` stands for the recording in messages.
FoundSensor find_sensor(const std::vector<RawPoints>& scans, std::optional<double> scan_period_s,
                        const std::string& source);

/// What find() returns; nothing where it throws Error: what is wrong with the points is reported
/// when they are read.
std::optional<FoundSensor> found_if_any(const std::function<FoundSensor()>& find);

/// Checks a stated sensor against the beams in the points where they could be found. Out: it, with
/// only the rows that have points, where these are evenly spaced ones. Throws Error for fewer or
/// other beams, as those of another preset.
FoundSensor held_against_points(const SensorModel& stated, const std::optional<FoundSensor>& found,
                                const std::string& source);

/// The sensor with the elevations of this individual unit, where as many beams were found as it has
/// and they are off its table: half of them by a tenth of a degree or more, none by more than 1.5.
/// Nothing otherwise.
std::optional<SensorModel> with_own_beams(const SensorModel& sensor,
                                          const std::vector<double>& found_rad);

/// The sensor of a recording with one scan per file, determined from some of at least one file. The
/// rate of turning follows from the stamps, else from the points' times. Files that cannot be read
/// are skipped. Throws Error where the points do not determine a sensor.
FoundSensor find_sensor_of_files(const std::vector<std::string>& paths,
                                 const std::vector<double>& stamps_s);

}  // namespace hqslam::recordings
