#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "hqslam/core/error.h"
#include "hqslam/core/organized_cloud.h"
#include "hqslam/slam/sensor_path.h"

namespace hqslam::slam {

/// Throws Error unless low <= value <= high; `map` is the kind of map whose option it is.
inline void check_option(const char* map, const char* field, double value, double low,
                         double high) {
  if (value >= low && value <= high) return;
  throw Error("{}: {} is {}, expected {} to {}", map, field, value, low, high);
}

/// Throws Error if the cloud's vectors do not have its shape or the path is not finite.
void check_mapped_scan(const OrganizedCloud& cloud, const SensorPath& path);

/// Pixels that are not finite count as no return.
inline bool has_return(const OrganizedCloud& cloud, std::size_t pixel) {
  return cloud.range_m[pixel] > 0.0F && std::isfinite(cloud.range_m[pixel]) &&
         cloud.points_m[pixel].allFinite() &&
         (cloud.time_offset_s.empty() || std::isfinite(cloud.time_offset_s[pixel]));
}

/// The poses of a sensor over one scan, one every so often: a scan has far more pixels than the
/// sensor has places that could be told apart. Between two entries a sensor at 20 m/s moves by
/// less than a millimetre.
class PathTable {
 public:
  /// For the capture times of a cloud; pixels without a return may have any.
  PathTable(const SensorPath& path, const OrganizedCloud& cloud);
  /// T_map_sensor when the pixel was measured.
  const Pose& at(std::size_t pixel) const;

 private:
  const std::vector<float>& time_offset_s_;
  double first_s_ = 0.0;
  double per_s_ = 0.0;
  std::vector<Pose> T_map_sensor_;
};

}  // namespace hqslam::slam
