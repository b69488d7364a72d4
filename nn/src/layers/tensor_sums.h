#pragma once

#include "../tensor.h"

namespace hqslam::nn {

/// to += from, without the borders.
inline void add(const Tensor& from, Tensor& to) {
  for (int channel = 0; channel < from.channels(); ++channel) {
    for (int y = 0; y < from.rows(); ++y) {
      const float* values = from.row(channel, y);
      float* sums = to.row(channel, y);
      for (int x = 0; x < from.columns(); ++x) sums[x] += values[x];
    }
  }
}

}  // namespace hqslam::nn
