#pragma once

#include "hqslam/core/organized_cloud.h"
#include "testing.h"

namespace hqslam::test {

/// One row of these points.
inline OrganizedCloud cloud_of(const std::vector<Eigen::Vector3f>& points_m) {
  OrganizedCloud cloud(1, static_cast<int>(points_m.size()));
  cloud.points_m = points_m;
  for (std::size_t i = 0; i < points_m.size(); ++i) cloud.range_m[i] = points_m[i].norm();
  return cloud;
}

}  // namespace hqslam::test
