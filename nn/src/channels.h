#pragma once

#include "tensor.h"

// Groups of channels of tensors, such as tiles and memory side by side. copy and clear: called by
// all threads of a parallel region, they share the work.
namespace hqslam::nn {

/// Rows of the channels from `from_channel` on, borders too.
void copy_channels(const Tensor& from, int from_channel, int channels, Tensor& to, int to_channel);

/// One row, by the calling thread alone.
void copy_channels_row(const Tensor& from, int from_channel, int channels, int row, Tensor& to,
                       int to_channel);

/// The channels of `from` from `first` on are added to as many of `to`, up to the last of either,
/// without the borders. By the calling thread alone.
void add_channels(const Tensor& from, int first, Tensor& to);

/// Zero from channel `from_channel` on, borders too.
void clear_channels(int from_channel, Tensor& tensor);
/// One row, by the calling thread alone.
void clear_channels_row(int from_channel, int row, Tensor& tensor);

}  // namespace hqslam::nn
