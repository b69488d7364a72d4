#pragma once

#include "tensor.h"

namespace hqslam::nn {

// The activations are max(v, slope v): slope 0 is ReLU, 0 < slope < 1 leaky ReLU, 1 the identity.
// Convolutions and batch norm apply them to their own result.

/// d_values: d loss / d output in, d loss / d input out; borders filled. The sign of the input is
/// that of the output for every slope > 0, and for slope 0 an output of 0 has derivative 0, as in
/// PyTorch.
void leaky_relu_backward(float slope, const Tensor& output, Tensor& d_values);

}  // namespace hqslam::nn
