#include "conv2d.h"

#include <fmt/format.h>

#include <utility>

#include "hqslam/core/error.h"
#include "kernels/bias.h"

namespace hqslam::nn {
namespace {

ConvolutionShape adjoint_of(ConvolutionShape shape) {
  std::swap(shape.input_channels, shape.output_channels);
  return shape;
}

kernels::StridedConvolution strided(const ConvolutionShape& shape, const Tensor& input,
                                    const Tensor& output, InstructionSet instruction_set) {
  return shape.transposed
             ? kernels::StridedConvolution(adjoint_of(shape), input, output, instruction_set)
             : kernels::StridedConvolution(shape, output, input, instruction_set);
}

}  // namespace

Conv2d::Conv2d(const ConvolutionShape& shape, const Tensor& input, const Tensor& output,
               InstructionSet instruction_set, int threads)
    : shape_(shape),
      convolution_(strided(shape, input, output, instruction_set)),
      scratch_(convolution_.make_scratch(threads)) {
  if (shape.transposed || !kernels::WinogradConvolution::suits(shape, input)) return;
  winograd_.emplace(shape, input, instruction_set, threads);
  adjoint_.emplace(adjoint_of(shape), output, instruction_set, threads);
}

void Conv2d::set_parameters(std::span<const float> weight, std::span<const float> bias) {
  if (winograd_) {
    winograd_->set_weights(weight);
    weight_.assign(weight.begin(), weight.end());
    adjoint_is_stale_ = true;
  } else {
    convolution_.set_weights(weight);
  }
  bias_ = kernels::padded_bias(bias, shape_.output_channels);
}

void Conv2d::forward(const Tensor& input, const LayerEnd& end, Tensor& output) {
  if (winograd_) {
    winograd_->forward(input, bias_.data(), end, output);
  } else if (shape_.transposed) {
    convolution_.scatter(input, bias_.data(), end, output, scratch_);
  } else {
    convolution_.gather(input, bias_.data(), end, output, scratch_);
  }
}

/// Throws Error unless single rows can be computed by themselves.
void Conv2d::require_single_rows() const {
  if (shape_.column_stride() == 1 && shape_.kernel_rows == 1) return;
  throw Error(fmt::format("conv2d: single rows with stride {} and {} kernel rows, expected 1, 1",
                          shape_.column_stride(), shape_.kernel_rows));
}

void Conv2d::forward_row(const Tensor& input, int row, float* output,
                         std::int64_t channel_stride) const {
  require_single_rows();
  convolution_.gather_row(input, bias_.data(), row, output, channel_stride);
}

void Conv2d::backward_input(const Tensor& d_output, const LayerEnd& end, Tensor& d_input) {
  if (shape_.transposed) {
    convolution_.gather(d_output, nullptr, end, d_input, scratch_);
    return;
  }
  if (!winograd_) {
    convolution_.scatter(d_output, nullptr, end, d_input, scratch_);
    return;
  }
  // Only who trains needs these.
#pragma omp single
  if (adjoint_is_stale_) {
    adjoint_->set_adjoint_weights(weight_);
    adjoint_is_stale_ = false;
  }
  adjoint_->forward(d_output, nullptr, end, d_input);
}

void Conv2d::backward_parameters(const Tensor& input, const Tensor& d_output,
                                 std::span<float> d_weight, std::span<float> d_bias) {
  if (winograd_) {
    winograd_->add_weight_gradient(input, d_output, d_weight);
  } else {
    const Tensor& narrow = shape_.transposed ? input : d_output;
    const Tensor& wide = shape_.transposed ? d_output : input;
    convolution_.add_weight_gradient(narrow, 0, wide, d_weight, scratch_);
  }
  kernels::add_bias_gradient(d_output, d_bias);
}

void Conv2d::backward_rows(const Tensor& input, int first_row, const Tensor& d_output,
                           const LayerEnd& end, Tensor& d_input, std::span<float> d_weight,
                           std::span<float> d_bias) {
  require_single_rows();
  convolution_.add_weight_gradient(d_output, first_row, input, d_weight, scratch_);
  kernels::add_bias_gradient(d_output, d_bias);
  convolution_.scatter_rows(d_output, first_row, end, d_input);
}

}  // namespace hqslam::nn
