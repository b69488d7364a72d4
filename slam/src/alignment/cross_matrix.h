#pragma once

#include <Eigen/Core>

namespace hqslam::slam {

/// cross_matrix(a) b = a x b
inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

}  // namespace hqslam::slam
