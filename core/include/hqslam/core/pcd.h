#pragma once

#include <string>

#include "hqslam/core/scan.h"

namespace hqslam {

/// A .pcd file (ascii, binary or binary_compressed; fields x y z and, where present, ring and one
/// of t, time, timestamp). Throws Error.
Scan read_pcd(const std::string& path);

/// Writes x y z (float32), binary.
void write_pcd(const std::vector<Eigen::Vector3f>& points_m, const std::string& path);

}  // namespace hqslam
