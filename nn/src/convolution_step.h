#pragma once

#include <string>

#include "conv2d.h"
#include "conv_transpose2d.h"
#include "hqslam/nn/hqs/network.h"
#include "tensor.h"

namespace hqslam::nn {

/// A convolution between two tensors as a step to be measured; all must outlive it. An output with
/// fewer channels than the convolution gives is one that is never kept: whoever asks replaces
/// `run`.
NetworkStep convolution_step(const std::string& name, Conv2d& layer, const Tensor& input,
                             const LayerEnd& end, Tensor& output);
NetworkStep convolution_step(const std::string& name, ConvTranspose2d& layer, const Tensor& input,
                             const LayerEnd& end, Tensor& output);

}  // namespace hqslam::nn
