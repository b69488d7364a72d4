#include "conv_transpose2d.h"

#include <utility>

#include "kernels/bias.h"
#include "kernels/strided_convolution.h"

namespace hqslam::nn {

struct ConvTranspose2d::Implementation {
  ConvolutionShape shape;
  kernels::StridedConvolution convolution;  // input: narrow side, output: wide side
  kernels::ConvolutionScratch scratch;
  std::vector<float> bias;
};

ConvTranspose2d::ConvTranspose2d(const ConvolutionShape& shape, const Tensor& input,
                                 const Tensor& output, InstructionSet instruction_set,
                                 int threads) {
  ConvolutionShape adjoint = shape;
  std::swap(adjoint.input_channels, adjoint.output_channels);
  kernels::StridedConvolution convolution(adjoint, input, output, instruction_set);
  kernels::ConvolutionScratch scratch = convolution.make_scratch(threads);
  implementation_ = std::make_unique<Implementation>(
      Implementation{shape, std::move(convolution), std::move(scratch), {}});
}
ConvTranspose2d::~ConvTranspose2d() = default;
ConvTranspose2d::ConvTranspose2d(ConvTranspose2d&&) noexcept = default;
ConvTranspose2d& ConvTranspose2d::operator=(ConvTranspose2d&&) noexcept = default;

const ConvolutionShape& ConvTranspose2d::shape() const { return implementation_->shape; }

void ConvTranspose2d::set_parameters(std::span<const float> weight, std::span<const float> bias) {
  implementation_->convolution.set_weights(weight);
  implementation_->bias = kernels::padded_bias(bias, shape().output_channels);
}

void ConvTranspose2d::forward(const Tensor& input, const LayerEnd& end, Tensor& output) {
  Implementation& self = *implementation_;
  self.convolution.scatter(input, {self.bias.data(), end.skip, end.negative_slope}, output,
                           self.scratch);
}

void ConvTranspose2d::backward_input(const Tensor& d_output, const InputGradientEnd& end,
                                     Tensor& d_input) {
  Implementation& self = *implementation_;
  self.convolution.gather(d_output, {nullptr, end.skip, end.negative_slope, end.activated}, d_input,
                          self.scratch);
}

void ConvTranspose2d::backward_parameters(const Tensor& input, const Tensor& d_output,
                                          std::span<float> d_weight, std::span<float> d_bias) {
  Implementation& self = *implementation_;
  self.convolution.add_weight_gradient(input, 0, d_output, d_weight, self.scratch);
  kernels::add_bias_gradient(d_output, d_bias);
}

}  // namespace hqslam::nn
