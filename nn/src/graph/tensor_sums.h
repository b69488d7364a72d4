#pragma once

#include "../tensor.h"

namespace hqslam::nn {

/// The channels of `from` from `first` on are added to those of `to`, as many as `to` has or the
/// first `channels` of them, without the borders.
inline void add_channels(const Tensor& from, int first, Tensor& to, int channels) {
  for (int channel = 0; channel < channels; ++channel) {
    for (int y = 0; y < from.rows(); ++y) {
      const float* values = from.row(first + channel, y);
      float* sums = to.row(channel, y);
      for (int x = 0; x < from.columns(); ++x) sums[x] += values[x];
    }
  }
}
inline void add_channels(const Tensor& from, int first, Tensor& to) {
  add_channels(from, first, to, to.channels());
}

}  // namespace hqslam::nn
