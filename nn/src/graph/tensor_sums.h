#pragma once

#include "../tensor.h"

namespace hqslam::nn {

/// The first `channels` channels of `from` are added to those of `to`, without the borders.
inline void add_channels(const Tensor& from, int channels, Tensor& to) {
  for (int channel = 0; channel < channels; ++channel) {
    for (int y = 0; y < from.rows(); ++y) {
      const float* values = from.row(channel, y);
      float* sums = to.row(channel, y);
      for (int x = 0; x < from.columns(); ++x) sums[x] += values[x];
    }
  }
}

}  // namespace hqslam::nn
