#pragma once

#include <optional>
#include <vector>

#include "hqslam/core/scan.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam {

/// The sensor with the beams of this very unit.
///
/// In:  its first scans with rows; the beam table of its kind.
/// Out: per row the median elevation of its points; rows with few points are as far from the table
///      as their neighbours. Nothing if the table fits (half of the rows within a tenth of a degree
///      of it), if any row is farther than 1.5 degrees from it, so that it is another sensor, or if
///      the elevations do not fall from row to row.
std::optional<SensorModel> with_own_elevations(const SensorModel& sensor,
                                               const std::vector<Scan>& scans);

}  // namespace hqslam
