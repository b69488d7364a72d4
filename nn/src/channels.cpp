#include "channels.h"

#include <algorithm>

namespace hqslam::nn {

void copy_channels(const Tensor& from, int from_channel, int channels, Tensor& to, int to_channel) {
#pragma omp for schedule(static)
  for (int row = 0; row < to.rows(); ++row) {
    copy_channels_row(from, from_channel, channels, row, to, to_channel);
  }
}

void copy_channels_row(const Tensor& from, int from_channel, int channels, int row, Tensor& to,
                       int to_channel) {
  for (int channel = 0; channel < channels; ++channel) {
    std::copy_n(from.row(from_channel + channel, row), to.columns(),
                to.row(to_channel + channel, row));
    to.fill_border(to_channel + channel, row);
  }
}

void add_channels(const Tensor& from, int first, Tensor& to) {
  const int channels = std::min(from.channels() - first, to.channels());
  for (int channel = 0; channel < channels; ++channel) {
    for (int y = 0; y < from.rows(); ++y) {
      const float* values = from.row(first + channel, y);
      float* sums = to.row(channel, y);
      for (int x = 0; x < from.columns(); ++x) sums[x] += values[x];
    }
  }
}

void clear_channels(int from_channel, Tensor& tensor) {
#pragma omp for schedule(static)
  for (int row = 0; row < tensor.rows(); ++row) clear_channels_row(from_channel, row, tensor);
}

void clear_channels_row(int from_channel, int row, Tensor& tensor) {
  for (int channel = from_channel; channel < tensor.channels(); ++channel) {
    std::fill_n(tensor.row(channel, row), tensor.columns(), 0.0F);
    tensor.fill_border(channel, row);
  }
}

}  // namespace hqslam::nn
