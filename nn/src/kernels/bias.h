#pragma once

#include <span>
#include <vector>

#include "../tensor.h"

namespace hqslam::nn::kernels {

/// One value per output channel, padded with zeros to whole blocks of kOutputBlock; all zero for an
/// empty bias. Throws Error for any other number than `channels`.
std::vector<float> padded_bias(std::span<const float> bias, int channels);

/// d_bias[c] += the sum over channel c of d_output; nothing for an empty d_bias.
void add_bias_gradient(const Tensor& d_output, std::span<float> d_bias);

}  // namespace hqslam::nn::kernels
