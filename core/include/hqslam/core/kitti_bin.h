#pragma once

#include <string>

#include "hqslam/core/scan.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam {

/// One scan as KITTI stores it: float32 x y z intensity per point, sensor frame. Rows are left
/// empty (see recover_rings). Points that are not finite or at the origin are dropped and counted.
/// Throws Error for a file of a wrong size, of text, or of numbers that cannot be coordinates.
Scan read_kitti_bin(const std::string& path);

/// Writes a scan in that form; unknown intensities become 0. Throws Error.
void write_kitti_bin(const Scan& scan, const std::string& path);

}  // namespace hqslam
