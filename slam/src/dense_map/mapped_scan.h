#pragma once

#include <cstddef>
#include <vector>

#include "front_end/scan_check.h"
#include "hqslam/slam/sensor_path.h"

namespace hqslam::slam {

/// A scan with the poses of its sensor, tabulated over time: far fewer than there are pixels.
/// Between two entries a sensor at 20 m/s moves by less than a millimetre.
class MappedScan {
 public:
  /// Throws Error if the cloud's vectors do not have its shape or the path is not finite. The cloud
  /// must outlive this object.
  MappedScan(const OrganizedCloud& cloud, const SensorPath& path);

  /// Pixels that are not finite count as no return.
  bool has_return(std::size_t pixel) const {
    return cloud_.range_m[pixel] > 0.0F && is_sound(cloud_, pixel);
  }
  /// The pose at the capture time of a pixel, which must have a return.
  const Pose& T_map_sensor(std::size_t pixel) const;
  Eigen::Vector3d point_in_map_m(std::size_t pixel) const {
    return T_map_sensor(pixel) * cloud_.points_m[pixel].cast<double>();
  }
  /// All points; NaN where there is no return within max_range_m.
  std::vector<Eigen::Vector3d> points_in_map_m(double max_range_m) const;

 private:
  const OrganizedCloud& cloud_;
  double first_s_ = 0.0;
  double per_s_ = 0.0;
  std::vector<Pose> T_map_sensor_;
};

}  // namespace hqslam::slam
