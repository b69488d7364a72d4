#pragma once

#include <optional>

#include "layer.h"

namespace hqslam::nn {

struct RowsAndColumns {
  int rows = 1;
  int columns = 1;
};

/// conv2d or conv_transpose2d, and what is done with its sums: a(sum + second input or row bias),
/// a(v) = max(v, negative_slope v). Arrays: weight, bias, row_bias.
struct ConvolutionOptions {
  int channels = 1;  ///< of the result
  RowsAndColumns kernel = {1, 1};
  RowsAndColumns stride = {1, 1};
  RowsAndColumns padding = {0, 0};
  /// The rows and columns of the result are those of the input times the strides.
  bool transposed = false;
  bool bias = true;       ///< a learned bias per output channel
  bool row_bias = false;  ///< one per output channel and row too; not with a second input
  bool linear = false;    ///< a 1 x 1 kernel whose weight is stored as out x in
  float negative_slope = 1.0F;
  /// Starting values: weights uniform in +-start_limit, biases start_bias; without a limit
  /// PyTorch's, weights in +-start_scale / sqrt(fan in), biases in +-0.1 start_scale.
  std::optional<float> start_limit = std::nullopt;
  float start_scale = 1.0F;
  float start_bias = 0.0F;
};

/// A 3 x 3 kernel on an image with a border of one pixel.
inline ConvolutionOptions three_by_three(int channels, float negative_slope, int stride = 1) {
  return {.channels = channels,
          .kernel = {3, 3},
          .stride = {stride, stride},
          .padding = {1, 1},
          .negative_slope = negative_slope};
}

class ConvolutionLayer final : public Layer {
 public:
  /// Throws Error if the options do not fit the input.
  ConvolutionLayer(const ConvolutionOptions& options, const TensorShape& input,
                   const Engine& engine);

  std::vector<ParameterShape> parameter_shapes() const override;
  void add_initial_parameters(UniformStart& start, std::vector<float>& parameters) const override;
  void set_parameters(std::span<const float> parameters) override;
  std::int64_t multiply_adds() const override;
  float negative_slope() const override { return options_.negative_slope; }
  bool ends_gradients() const override { return true; }
  void forward(const LayerPass& pass) override;
  void backward(std::span<const BackwardPass> batch, std::span<float> d_parameters) override;
  std::function<void()> reference(const LayerPass& pass) const override;

  /// Conv2d::forward_row and backward_rows.
  void forward_row(const Tensor& input, int row, float* output, std::int64_t channel_stride) const {
    layer_.forward_row(input, row, output, channel_stride);
  }
  void backward_rows(const Tensor& input, int first_row, const Tensor& d_output,
                     const LayerEnd& end, Tensor& d_input, std::span<float> d_parameters);

 private:
  ConvolutionOptions options_;
  ConvolutionShape shape_;
  TensorShape input_;
  Conv2d layer_;
  Tensor row_bias_;  ///< of the result's shape; empty: none
};

}  // namespace hqslam::nn
