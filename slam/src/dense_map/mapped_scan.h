#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/slam/sensor_path.h"

namespace hqslam::slam {

/// A scan with the poses of its sensor, one every so often: a scan has far more pixels than the
/// sensor has places that could be told apart. Between two entries a sensor at 20 m/s moves by less
/// than a millimetre.
class MappedScan {
 public:
  /// Throws Error if the cloud's vectors do not have its shape or the path is not finite. The cloud
  /// must live on; its pixels without a return may have any capture time.
  MappedScan(const OrganizedCloud& cloud, const SensorPath& path);

  /// Pixels that are not finite count as no return.
  bool has_return(std::size_t pixel) const {
    return cloud_.range_m[pixel] > 0.0F && std::isfinite(cloud_.range_m[pixel]) &&
           cloud_.points_m[pixel].allFinite() &&
           (cloud_.time_offset_s.empty() || std::isfinite(cloud_.time_offset_s[pixel]));
  }
  /// When the pixel, which has a return, was measured.
  const Pose& T_map_sensor(std::size_t pixel) const;
  Eigen::Vector3d point_in_map_m(std::size_t pixel) const {
    return T_map_sensor(pixel) * cloud_.points_m[pixel].cast<double>();
  }

 private:
  const OrganizedCloud& cloud_;
  double first_s_ = 0.0;
  double per_s_ = 0.0;
  std::vector<Pose> T_map_sensor_;
};

}  // namespace hqslam::slam
