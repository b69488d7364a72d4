#pragma once

#include "testing.h"

namespace hqslam::test {

inline double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}
/// From 0.
inline double deviation_of(std::vector<double> values) {
  for (double& value : values) value *= value;
  return std::sqrt(mean_of(values));
}

}  // namespace hqslam::test
