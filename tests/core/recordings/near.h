#pragma once

#include <Eigen/Core>

#include "testing.h"

namespace hqslam::test {

/// Whether two measurements are the same but for rounding.
inline bool near(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return (a - b).norm() < 1e-6;
}

}  // namespace hqslam::test
