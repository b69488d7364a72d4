#pragma once

#include "hqslam/core/imu_sample.h"
#include "testing.h"

namespace hqslam::test {

inline const Eigen::Vector3d kGravity(0, 0, -kGravity_mps2);  // map frame
inline const Eigen::Vector3d kBias_mps2(0.1, -0.05, 0.02);    // equivalent to 0.7 degrees

}  // namespace hqslam::test
