#include "front_end/segmentation.h"

#include "front_end/ground.h"

namespace hqslam::slam {

Segmentation segment(const OrganizedCloud& cloud, const SensorModel& sensor,
                     const Eigen::Vector3d& up_of_sensor) {
  const std::vector<std::uint8_t> ground = mark_ground(cloud, sensor, up_of_sensor);
  Segmentation result;
  result.pixel_class.assign(cloud.range_m.size(), PixelClass::kNoReturn);
  for (std::size_t i = 0; i < cloud.range_m.size(); ++i) {
    if (cloud.range_m[i] <= 0.0F) continue;
    ++result.returns;
    result.ground_points += ground[i];
    result.pixel_class[i] = ground[i] != 0 ? PixelClass::kGround : PixelClass::kObject;
  }
  return result;
}

}  // namespace hqslam::slam
