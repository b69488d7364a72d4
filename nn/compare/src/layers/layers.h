#pragma once

#include <memory>

#include "graph/convolution_layer.h"
#include "graph/layer_backward.h"

// The layers of SRAE beside convolutions.
namespace hqslam::nn {

inline constexpr float kBatchNormEpsilon = 1e-3F;  ///< of Keras

/// Batch normalisation (Ioffe & Szegedy, 2015) and what is done with its result:
///   y = a(weight (x - mean) / sqrt(variance + epsilon) + bias), a(v) = max(v, negative_slope v)
/// per channel, with mean and variance over all pixels of the whole batch when training and the
/// arrays running_mean and running_var otherwise. The gradient of these two is their distance to
/// the batch's, so that a step of 0.01 down it is the running mean of Keras (momentum 0.99).
/// Arrays: weight, bias, running_mean, running_var.
std::unique_ptr<Layer> make_batch_norm(float negative_slope, const TensorShape& input);

/// The mean of each 2 x 2 pixels.
std::unique_ptr<Layer> make_average_pool(const TensorShape& input);

/// The channels of the first input, then those of the second.
std::unique_ptr<Layer> make_concatenation(const TensorShape& first, const TensorShape& second);

}  // namespace hqslam::nn
