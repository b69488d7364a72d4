#pragma once

#include <algorithm>
#include <random>
#include <vector>

#include "hqslam/core/imu_sample.h"
#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/pose.h"

namespace hqslam::test {

inline const Eigen::Vector3d kGravity(0, 0, -kGravity_mps2);  // map frame
inline const Eigen::Vector3d kBias_mps2(0.1, -0.05, 0.02);    // looks like 0.7 degrees

inline Pose at_x(double x_m) { return pose_from_xyz_rpy({x_m, 0.0, 0.0}, 0.0, 0.0, 0.0); }

/// One row of these points.
inline OrganizedCloud cloud_of(const std::vector<Eigen::Vector3f>& points_m) {
  OrganizedCloud cloud(1, static_cast<int>(points_m.size()));
  cloud.points_m = points_m;
  for (std::size_t i = 0; i < points_m.size(); ++i) cloud.range_m[i] = points_m[i].norm();
  return cloud;
}

/// From -1 to 1, the same on every machine.
inline double random_unit(std::mt19937& generator) {
  return static_cast<double>(generator() % 20001) / 10000.0 - 1.0;
}

inline double worst_error_m(const std::vector<Pose>& poses, const std::vector<Pose>& truth) {
  double worst_m = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    worst_m = std::max(worst_m, (poses[i].translation() - truth[i].translation()).norm());
  }
  return worst_m;
}

}  // namespace hqslam::test
