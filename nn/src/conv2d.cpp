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
  std::optional<kernels::WinogradConvolution> winograd;  // forward, where it is faster
};

Conv2d::Conv2d(const ConvolutionShape& shape, const Tensor& input, const Tensor& output,
               InstructionSet instruction_set, int threads) {
  kernels::StridedConvolution convolution(shape, output, input, instruction_set);
  kernels::ConvolutionScratch scratch = convolution.make_scratch(threads);
  implementation_ = std::make_unique<Implementation>(
      Implementation{shape, std::move(convolution), std::move(scratch), {}, {}});
  if (kernels::WinogradConvolution::suits(shape, input)) {
    implementation_->winograd.emplace(shape, input, instruction_set, threads);
  }
}
Conv2d::~Conv2d() = default;
Conv2d::Conv2d(Conv2d&&) noexcept = default;
Conv2d& Conv2d::operator=(Conv2d&&) noexcept = default;

const ConvolutionShape& Conv2d::shape() const { return implementation_->shape; }

void Conv2d::set_parameters(std::span<const float> weight, std::span<const float> bias) {
  implementation_->convolution.set_weights(weight);
  if (implementation_->winograd) implementation_->winograd->set_weights(weight);
  implementation_->bias = kernels::padded_bias(bias, shape().output_channels);
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

void Conv2d::forward_row(const Tensor& input, int row, float* output,
                         std::int64_t channel_stride) const {
  const Implementation& self = *implementation_;
  if (self.shape.column_stride() != 1) {
    throw Error(
        fmt::format("conv2d: single rows with stride {}, expected 1", self.shape.column_stride()));
  }
  self.convolution.gather_row(input, self.bias.data(), row, output, channel_stride, self.scratch);
}

void Conv2d::backward_input(const Tensor& d_output, const InputGradientEnd& end, Tensor& d_input) {
  Implementation& self = *implementation_;
  self.convolution.scatter(d_output, {nullptr, end.skip, end.negative_slope, end.activated},
                           d_input, self.scratch);
}

void Conv2d::backward_parameters(const Tensor& input, const Tensor& d_output,
                                 std::span<float> d_weight, std::span<float> d_bias) {
  Implementation& self = *implementation_;
  self.convolution.add_weight_gradient(d_output, input, d_weight, self.scratch);
  kernels::add_bias_gradient(d_output, d_bias);
}

}  // namespace hqslam::nn
