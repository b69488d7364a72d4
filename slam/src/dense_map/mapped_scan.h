#pragma once

#include <cmath>
#include <cstddef>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/slam/sensor_path.h"

namespace hqslam::slam {

/// Throws Error if the cloud's vectors do not have its shape or the path is not finite.
void check_mapped_scan(const OrganizedCloud& cloud, const SensorPath& path);

/// Pixels that are not finite count as no return.
inline bool has_return(const OrganizedCloud& cloud, std::size_t pixel) {
  return cloud.range_m[pixel] > 0.0F && std::isfinite(cloud.range_m[pixel]) &&
         cloud.points_m[pixel].allFinite() &&
         (cloud.time_offset_s.empty() || std::isfinite(cloud.time_offset_s[pixel]));
}

}  // namespace hqslam::slam
