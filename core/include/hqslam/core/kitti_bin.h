#pragma once

#include <string>

#include "hqslam/core/scan.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam {

/// One scan as KITTI stores it: float32 x y z intensity per point, sensor frame. Rows are left
/// empty (see recover_rings). Throws Error.
Scan read_kitti_bin(const std::string& path);
void write_kitti_bin(const Scan& scan, const std::string& path);

}  // namespace hqslam
