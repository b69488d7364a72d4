#pragma once

#include <memory>

#include "graph/convolution_layer.h"
#include "graph/layer_backward.h"

// The layers of the compared networks. All of them work on channels x rows x columns,
// transformers' too: a token is a pixel, and a linear layer of tokens a 1 x 1
// convolution.
namespace hqslam::nn {

inline constexpr float kBatchNormEpsilon = 1e-3F;  ///< of Keras
inline constexpr float kLayerNormEpsilon = 1e-6F;

/// Batch normalisation (Ioffe & Szegedy, 2015) and what is done with its result:
///   y = a(weight (x - mean) / sqrt(variance + epsilon) + bias), a(v) = max(v, negative_slope v)
/// per channel, with mean and variance over all pixels of the whole batch when training and the
/// arrays running_mean and running_var otherwise. The gradient of these two is their distance to
/// the batch's, so that a step of 0.01 down it is the running mean of Keras (momentum 0.99).
/// Arrays: weight, bias, running_mean, running_var.
std::unique_ptr<Layer> make_batch_norm(float negative_slope, const TensorShape& input);
/// For upsampling: a convolution with the batch norm behind it worked into its weights. Arrays:
/// convolution.*, norm.*.
std::unique_ptr<Layer> make_normalised_convolution(const ConvolutionOptions& options,
                                                   const TensorShape& input, const Engine& engine);

/// The mean of each 2 x 2 pixels.
std::unique_ptr<Layer> make_average_pool(const TensorShape& input);

/// The channels of the first input, then those of the second.
std::unique_ptr<Layer> make_concatenation(const TensorShape& first, const TensorShape& second);

/// Layer normalisation (Ba et al., 2016): every pixel's channels to mean 0 and variance 1, then
/// times weight plus bias. Arrays: weight, bias.
std::unique_ptr<Layer> make_layer_norm(const TensorShape& input);

/// x P(X < x) for a standard normal X (Hendrycks & Gimpel, 2016).
std::unique_ptr<Layer> make_gelu(const TensorShape& input, const Engine& engine);

inline constexpr int kWindowRows = 2;
inline constexpr int kWindowColumns = 8;
/// Attention within windows of 2 x 8 pixels, after Liu et al., "Swin Transformer", 2021. Channels
/// of the input: queries q, keys k, values v, each split into `heads` parts of depth d. For every
/// head and window, i and j in the window, b the array relative_position_bias_table:
///   output_i = sum_j softmax_j(q_i k_j / sqrt(d) + b[place of i relative to j]) v_j
/// With a shift the windows begin half a window to the right and down; those that then reach beyond
/// the last row or column go on at the other end, and pixels of the two ends do not attend to each
/// other.
struct WindowAttentionOptions {
  int heads = 1;
  bool shifted = false;
  /// The last column is a neighbour of the first, and they attend to each other.
  bool circular = false;
};
std::unique_ptr<Layer> make_window_attention(const WindowAttentionOptions& options,
                                             const TensorShape& input, const Engine& engine);

/// Pixels of 2 x 2 patches side by side in the channels: (0, 0), (1, 0), (0, 1), (1, 1).
std::unique_ptr<Layer> make_patch_merging(const TensorShape& input);

/// Channel (c factor + i) factor + j of a pixel becomes row i, column j of channel c of a patch of
/// factor x factor pixels (Shi et al., 2016).
std::unique_ptr<Layer> make_pixel_shuffle(int factor, const TensorShape& input);

}  // namespace hqslam::nn
