#pragma once

#include <memory>

#include "hqslam/core/scan_source.h"

namespace hqslam::recordings {

/// The scans of a recording without the pixels that hold one range instead of none.
///
/// Simulators and some drivers store a beam that met nothing as a return at the largest range, be
/// it the sensor's or another. These pixels would be a sphere around the sensor, which moves with
/// it. Where at least 2 % of a scan's returns, and not nearly all, are within 2 mm of one range,
/// and at most 1.5 % are farther, they become pixels without a return and count as out of range,
/// with a warning.
std::unique_ptr<ScanSource> without_limit_returns(std::unique_ptr<ScanSource> source);

}  // namespace hqslam::recordings
