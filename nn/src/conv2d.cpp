#include "conv2d.h"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "hqslam/core/error.h"
#include "kernels/bias.h"
#include "kernels/strided_convolution.h"
#include "kernels/winograd_convolution.h"

namespace hqslam::nn {

struct Conv2d::Implementation {
  ConvolutionShape shape;
  kernels::StridedConvolution convolution;  // input: wide side, output: narrow side
  kernels::ConvolutionScratch scratch;
  std::vector<float> bias;
  /// Where it is faster, forward and backward.
  std::optional<kernels::WinogradConvolution> winograd = std::nullopt;
  std::optional<kernels::WinogradConvolution> adjoint = std::nullopt;
  std::vector<float> weight = {};  ///< of what goes Winograd's way
  bool adjoint_is_stale = true;
};

Conv2d::Conv2d(const ConvolutionShape& shape, const Tensor& input, const Tensor& output,
               InstructionSet instruction_set, int threads) {
  kernels::StridedConvolution convolution(shape, output, input, instruction_set);
  kernels::ConvolutionScratch scratch = convolution.make_scratch(threads);
  implementation_ = std::make_unique<Implementation>(
      Implementation{shape, std::move(convolution), std::move(scratch), {}});
  if (kernels::WinogradConvolution::suits(shape, input)) {
    ConvolutionShape adjoint = shape;
    std::swap(adjoint.input_channels, adjoint.output_channels);
    implementation_->winograd.emplace(shape, input, instruction_set, threads);
    implementation_->adjoint.emplace(adjoint, output, instruction_set, threads);
  }
}
Conv2d::~Conv2d() = default;
Conv2d::Conv2d(Conv2d&&) noexcept = default;
Conv2d& Conv2d::operator=(Conv2d&&) noexcept = default;

const ConvolutionShape& Conv2d::shape() const { return implementation_->shape; }

void Conv2d::set_parameters(std::span<const float> weight, std::span<const float> bias) {
  Implementation& self = *implementation_;
  if (self.winograd) {
    self.winograd->set_weights(weight);
    self.weight.assign(weight.begin(), weight.end());
    self.adjoint_is_stale = true;
  } else {
    self.convolution.set_weights(weight);
  }
  self.bias = kernels::padded_bias(bias, shape().output_channels);
}

void Conv2d::forward(const Tensor& input, const LayerEnd& end, Tensor& output) {
  Implementation& self = *implementation_;
  const kernels::StridedConvolution::Epilogue epilogue{self.bias.data(), end.skip,
                                                       end.negative_slope};
  if (self.winograd) {
    self.winograd->forward(input, epilogue, output);
  } else {
    self.convolution.gather(input, epilogue, output, self.scratch);
  }
}

/// Throws Error unless single rows can be computed by themselves.
static void require_single_rows(const ConvolutionShape& shape) {
  if (shape.column_stride() == 1 && shape.kernel_rows == 1) return;
  throw Error(fmt::format("conv2d: single rows with stride {} and {} kernel rows, expected 1, 1",
                          shape.column_stride(), shape.kernel_rows));
}

void Conv2d::forward_row(const Tensor& input, int row, float* output,
                         std::int64_t channel_stride) const {
  const Implementation& self = *implementation_;
  require_single_rows(self.shape);
  self.convolution.gather_row(input, self.bias.data(), row, output, channel_stride);
}

void Conv2d::backward_input(const Tensor& d_output, const InputGradientEnd& end, Tensor& d_input) {
  Implementation& self = *implementation_;
  const kernels::StridedConvolution::Epilogue epilogue{nullptr, end.skip, end.negative_slope,
                                                       end.activated};
  if (!self.winograd) {
    self.convolution.scatter(d_output, epilogue, d_input, self.scratch);
    return;
  }
  // Only who trains needs these.
#pragma omp single
  if (self.adjoint_is_stale) {
    self.adjoint->set_adjoint_weights(self.weight);
    self.adjoint_is_stale = false;
  }
  self.adjoint->forward(d_output, epilogue, d_input);
}

void Conv2d::backward_parameters(const Tensor& input, const Tensor& d_output,
                                 std::span<float> d_weight, std::span<float> d_bias) {
  Implementation& self = *implementation_;
  if (self.winograd) {
    self.winograd->add_weight_gradient(input, d_output, d_weight);
  } else {
    self.convolution.add_weight_gradient(d_output, 0, input, d_weight, self.scratch);
  }
  kernels::add_bias_gradient(d_output, d_bias);
}

void Conv2d::backward_rows(const Tensor& input, int first_row, const Tensor& d_output,
                           const InputGradientEnd& end, Tensor& d_input, std::span<float> d_weight,
                           std::span<float> d_bias) {
  Implementation& self = *implementation_;
  require_single_rows(self.shape);
  self.convolution.add_weight_gradient(d_output, first_row, input, d_weight, self.scratch);
  kernels::add_bias_gradient(d_output, d_bias);
  self.convolution.scatter_rows(d_output, first_row,
                                {nullptr, end.skip, end.negative_slope, end.activated}, d_input);
}

}  // namespace hqslam::nn
