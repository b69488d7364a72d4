#pragma once

#include "testing.h"

namespace hqslam::test {

/// From -1 to 1, the same on every machine.
inline double random_unit(std::mt19937& generator) {
  return static_cast<double>(generator() % 20001) / 10000.0 - 1.0;
}
/// Three of them.
inline Eigen::Vector3d random_vector(std::mt19937& generator) {
  return {random_unit(generator), random_unit(generator), random_unit(generator)};
}

}  // namespace hqslam::test
