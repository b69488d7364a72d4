#pragma once

#include <memory>

#include "layer.h"

namespace hqslam::nn {

/// conv2d or conv_transpose2d, and what is done with its sums: a(sum + second input, if it has
/// one), a(v) = max(v, negative_slope v). Arrays: weight, bias.
struct ConvolutionOptions {
  int channels = 1;  ///< of the result
  int kernel_rows = 1;
  int kernel_columns = 1;
  int stride_rows = 1;
  int stride_columns = 1;
  int padding_rows = 0;
  int padding_columns = 0;
  /// The rows and columns of the result are those of the input times the strides.
  bool transposed = false;
  bool bias = true;
  bool linear = false;  ///< a 1 x 1 kernel whose weight is stored as out x in
  float negative_slope = 1.0F;
  float start_deviation = 0.02F;  ///< standard deviation of the weights' uniform start
  float start_bias = 0.0F;
};
std::unique_ptr<Layer> make_convolution(const ConvolutionOptions& options, const TensorShape& input,
                                        const Engine& engine);

}  // namespace hqslam::nn
