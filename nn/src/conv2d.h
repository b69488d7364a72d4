#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "convolution_shape.h"
#include "hqslam/nn/instruction_set.h"
#include "kernels/strided_convolution.h"
#include "kernels/winograd_convolution.h"
#include "layer_end.h"
#include "tensor.h"

namespace hqslam::nn {

/// 2-D convolution (cross-correlation, as everywhere in deep learning):
///   output[o][y][x] = bias[o] + sum_{i, r, c} weight[o][i][r][c]
///                                input[i][y stride + r - padding][x stride + c - padding]
/// or, where the shape says `transposed`, its adjoint ("deconvolution"):
///   output[o][y stride + r - padding][x stride + c - padding] += weight[i][o][r][c] input[i][y][x]
/// plus bias[o]. Rows beyond the edge are zero or dropped, columns continue as the input's
/// ColumnPadding says. The output's shape decides between those that one input shape could have.
///
/// One object serves one pair of shapes and one thread team at a time. Called by all threads of an
/// OpenMP parallel region, the team shares the work; the result does not depend on its size.
/// No call allocates but the first of a thread, and backward_input after new parameters.
class Conv2d {
 public:
  /// Throws Error if the shapes do not fit.
  Conv2d(const ConvolutionShape& shape, const Tensor& input, const Tensor& output,
         InstructionSet instruction_set, int threads = 1);

  /// weight: output x input x kernel rows x kernel columns, transposed: input x output x ...; bias:
  /// output channels, or empty for none. Throws Error if a size differs.
  void set_parameters(std::span<const float> weight, std::span<const float> bias);

  /// Borders of the input must be filled; those of the output will be.
  void forward(const Tensor& input, const LayerEnd& end, Tensor& output);

  /// One row of the linear result, into memory of the caller's, so that what follows can use it
  /// while it is in the cache: output channels are channel_stride floats apart, each with room for
  /// the columns rounded up to 16. By the calling thread alone. Throws Error unless stride
  /// and kernel rows are 1.
  void forward_row(const Tensor& input, int row, float* output, std::int64_t channel_stride) const;

  /// d_input = the gradient with respect to the input, with end.skip (another gradient of the same
  /// input) and end.activated (what made the input); borders of d_output (before the layer's
  /// activation) must be filled.
  void backward_input(const Tensor& d_output, const LayerEnd& end, Tensor& d_input);
  /// Adds to d_weight and d_bias (empty: none). One thread.
  void backward_parameters(const Tensor& input, const Tensor& d_output, std::span<float> d_weight,
                           std::span<float> d_bias);
  /// Both gradients from some rows of the result alone, `first_row` and what follows it, which is
  /// all that d_output has, while they are in the cache. One thread. Throws Error unless stride and
  /// kernel rows are 1.
  void backward_rows(const Tensor& input, int first_row, const Tensor& d_output,
                     const LayerEnd& end, Tensor& d_input, std::span<float> d_weight,
                     std::span<float> d_bias);

  const ConvolutionShape& shape() const { return shape_; }

 private:
  void require_single_rows() const;

  ConvolutionShape shape_;
  kernels::StridedConvolution convolution_;
  kernels::ConvolutionScratch scratch_;
  std::vector<float> bias_;
  /// Where it is faster, forward and backward.
  std::optional<kernels::WinogradConvolution> winograd_;
  std::optional<kernels::WinogradConvolution> adjoint_;
  std::vector<float> weight_;  ///< of what goes Winograd's way
  bool adjoint_is_stale_ = true;
};

/// The same, written as the formulas above.
void conv2d_reference(const ConvolutionShape& shape, std::span<const float> weight,
                      std::span<const float> bias, const Tensor& input, Tensor& output);
/// The gradients, written as their derivatives. d_input is overwritten, the others are added to.
void conv2d_backward_reference(const ConvolutionShape& shape, std::span<const float> weight,
                               const Tensor& input, const Tensor& d_output, Tensor& d_input,
                               std::span<float> d_weight, std::span<float> d_bias);

}  // namespace hqslam::nn
