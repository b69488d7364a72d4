#pragma once

#include <memory>
#include <span>

#include "conv2d.h"
#include "convolution_shape.h"
#include "hqslam/nn/instruction_set.h"
#include "tensor.h"

namespace hqslam::nn {

/// 2-D transposed convolution ("deconvolution"), the adjoint of conv2d with the same stride and
/// padding:
///   output[o][y stride + r - padding][x stride + c - padding] += weight[i][o][r][c] input[i][y][x]
/// plus bias[o]. Rows beyond the edge are dropped; columns go round where the input's ColumnPadding
/// is circular. The output's shape decides between those that one input shape could have.
///
/// One object serves one pair of shapes and one thread team at a time. Called by all threads of an
/// OpenMP parallel region, the team shares the work; the result does not depend on its size.
/// No call allocates.
class ConvTranspose2d {
 public:
  /// Throws Error if the shapes do not fit.
  ConvTranspose2d(const ConvolutionShape& shape, const Tensor& input, const Tensor& output,
                  InstructionSet instruction_set, int threads = 1);
  ~ConvTranspose2d();
  ConvTranspose2d(ConvTranspose2d&&) noexcept;  ///< moved from: only assign or destroy
  ConvTranspose2d& operator=(ConvTranspose2d&&) noexcept;

  /// weight: input x output x kernel rows x kernel columns; bias: output channels, or empty for
  /// none. Throws Error if a size differs.
  void set_parameters(std::span<const float> weight, std::span<const float> bias);

  /// Borders of the input must be filled; those of the output will be.
  void forward(const Tensor& input, const LayerEnd& end, Tensor& output);
  /// d_input = the gradient with respect to the input, plus `end.skip` (another gradient of the
  /// same input). Borders of d_output (before the activation) must be filled.
  void backward_input(const Tensor& d_output, const InputGradientEnd& end, Tensor& d_input);
  /// Adds to d_weight and d_bias (empty: none). One thread.
  void backward_parameters(const Tensor& input, const Tensor& d_output, std::span<float> d_weight,
                           std::span<float> d_bias);

  const ConvolutionShape& shape() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// The same, written as the formula above.
void conv_transpose2d_reference(const ConvolutionShape& shape, std::span<const float> weight,
                                std::span<const float> bias, const Tensor& input, Tensor& output);
/// The gradients, written as its derivatives. d_input is overwritten, the others are added to.
void conv_transpose2d_backward_reference(const ConvolutionShape& shape,
                                         std::span<const float> weight, const Tensor& input,
                                         const Tensor& d_output, Tensor& d_input,
                                         std::span<float> d_weight, std::span<float> d_bias);

}  // namespace hqslam::nn
