#pragma once

#include <optional>

#include "kernels/strided_convolution.h"
#include "kernels/winograd_convolution.h"
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
  /// Weights and biases of each row, for a 1 x 1 kernel without activation or second input: arrays
  /// of rows x out x in and rows x out.
  bool row_weights = false;
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

/// Computed by the kernel that suits. One object serves one pair of shapes and one thread team at a
/// time. Only the first call of a thread allocates.
class ConvolutionLayer final : public Layer {
 public:
  /// Throws Error if the options do not fit the input.
  ConvolutionLayer(const ConvolutionOptions& options, const TensorShape& input,
                   const Engine& engine);
  /// Between tensors of these shapes and borders; the output's shape decides between those that one
  /// input shape could have. Throws Error if they do not fit.
  ConvolutionLayer(const ConvolutionOptions& options, const Tensor& input, const Tensor& output,
                   const Engine& engine);

  std::vector<ParameterShape> parameter_shapes() const override;
  void add_initial_parameters(UniformStart& start, std::vector<float>& parameters) const override;
  /// Throws Error for another number.
  void set_parameters(std::span<const float> parameters) override;
  std::int64_t multiply_adds() const override;
  float negative_slope() const override { return options_.negative_slope; }
  void forward(const LayerPass& pass) override;

  /// One row of the linear result, into memory of the caller's, so that what follows can use it
  /// while it is in the cache: output channels are channel_stride floats apart, each with room for
  /// the columns rounded up to 16. By the calling thread alone. Throws Error unless stride
  /// and kernel rows are 1.
  void forward_row(const Tensor& input, int row, float* output, std::int64_t channel_stride) const;
  /// For the backward pass.
  const ConvolutionOptions& options() const { return options_; }
  const ConvolutionShape& shape() const { return shape_; }
  const kernels::StridedConvolution& strided() const { return convolution_; }
  /// What computes one row of the result.
  const kernels::StridedConvolution& strided(int row) const {
    return of_rows_.empty() ? convolution_ : of_rows_[row];
  }
  kernels::ConvolutionScratch& scratch() { return scratch_; }
  /// Null where strided() computes the layer.
  const kernels::WinogradConvolution* winograd() const { return winograd_ ? &*winograd_ : nullptr; }
  /// Throws Error unless single rows can be computed by themselves.
  void require_single_rows() const;

 private:
  void set_row_parameters(std::span<const float> parameters);

  ConvolutionOptions options_;
  ConvolutionShape shape_;
  TensorShape input_;
  kernels::StridedConvolution convolution_;
  int threads_;
  kernels::ConvolutionScratch scratch_;  ///< made with the first parameters, where it is needed
  std::vector<float> bias_;  ///< padded with zeros to whole blocks; with row_weights row by row
  std::vector<kernels::StridedConvolution> of_rows_;      ///< with row_weights
  std::optional<kernels::WinogradConvolution> winograd_;  ///< where it is faster
  Tensor row_bias_;                                       ///< in the result's shape; empty: none
};

}  // namespace hqslam::nn
