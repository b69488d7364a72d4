#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "hqslam/evaluation/png.h"
#include "report/chart.h"

namespace hqslam::tools {

/// Points seen from above: each pixel is the darker, the more points lie over it (logarithmic, a
/// few grey levels so that the file is small). White where there is none. `box` in metres, x to
/// the right, y upwards.
RgbImage density_from_above(const std::vector<Eigen::Vector3f>& points_m, const PlotBox& box,
                            int rows, int columns);

/// Bytes as base64 (RFC 4648, with padding).
std::string base64(const std::vector<std::uint8_t>& bytes);

}  // namespace hqslam::tools
