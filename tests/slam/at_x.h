#pragma once

#include "hqslam/core/pose.h"

namespace hqslam::test {

inline Pose at_x(double x_m) { return pose_from_xyz_rpy({x_m, 0.0, 0.0}, 0.0, 0.0, 0.0); }

}  // namespace hqslam::test
