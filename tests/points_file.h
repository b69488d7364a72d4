#pragma once

#include "hqslam/core/cloud_file.h"
#include "testing.h"

namespace hqslam::test {

/// Points of which nothing else is known, in the format of the name's ending.
inline void write_points(const std::vector<Eigen::Vector3f>& points_m, const std::string& path) {
  Scan scan;
  scan.points_m = points_m;
  write_cloud(scan, path);
}

}  // namespace hqslam::test
