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
