#pragma once

#include "hqslam/core/pose.h"

namespace hqslam::sim {

/// Where the sensor is.
class SensorMotion {
 public:
  virtual ~SensorMotion() = default;
  virtual Pose T_world_sensor(double time_s) const = 0;
};

}  // namespace hqslam::sim
