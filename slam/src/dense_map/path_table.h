#pragma once

#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/slam/sensor_path.h"

namespace hqslam::slam {

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
