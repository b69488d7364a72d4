#include <cmath>
#include <utility>

#include "layers.h"

namespace hqslam::nn {
namespace {

/// Lifting alone: it has no gradients.
class NormalisedConvolution final : public Layer {
 public:
  NormalisedConvolution(const ConvolutionOptions& options, float epsilon, const TensorShape& input,
                        const Engine& engine)
      : Layer({}),
        // conv_transpose2d's weights have the input channels first.
        outer_(options.transposed ? input.channels : 1),
        epsilon_(epsilon),
        convolution_(options, input, engine) {
    output_ = convolution_.output_shape();
  }

  std::int64_t multiply_adds() const override { return convolution_.multiply_adds(); }
  void forward(const LayerPass& pass) override { convolution_.forward(pass); }
  void backward(std::span<const BackwardPass> /*batch*/, std::span<float> /*d*/) override {}

  std::vector<ParameterShape> parameter_shapes() const override {
    std::vector<ParameterShape> shapes;
    add_part("convolution", convolution_.parameter_shapes(), shapes);
    add_part("norm", make_batch_norm(epsilon_, 1.0F, output_)->parameter_shapes(), shapes);
    return shapes;
  }

  /// weight' = weight s, bias' = (bias - mean) s + shift with s = scale / sqrt(variance + epsilon)
  void set_parameters(std::span<const float> parameters) override {
    const std::int64_t own = elements(convolution_.parameter_shapes());
    const std::span<const float> convolution = take(parameters, own);
    std::vector<float> folded(convolution.begin(), convolution.end());
    const std::span<const float> scale = take(parameters, output_.channels);
    const std::span<const float> shift = take(parameters, output_.channels);
    const std::span<const float> mean = take(parameters, output_.channels);
    const std::span<const float> variance = take(parameters, output_.channels);
    const std::int64_t weights = own - output_.channels;
    const std::int64_t inner = weights / (static_cast<std::int64_t>(outer_) * output_.channels);
    for (int channel = 0; channel < output_.channels; ++channel) {
      const float s = scale[channel] / std::sqrt(variance[channel] + epsilon_);
      for (std::int64_t outer = 0; outer < outer_; ++outer) {
        float* weight = &folded[(outer * output_.channels + channel) * inner];
        for (std::int64_t i = 0; i < inner; ++i) weight[i] *= s;
      }
      float& bias = folded[weights + channel];
      bias = (bias - mean[channel]) * s + shift[channel];
    }
    convolution_.set_parameters(folded);
  }

 private:
  int outer_;
  float epsilon_;
  ConvolutionLayer convolution_;
};

}  // namespace

std::unique_ptr<Layer> make_normalised_convolution(const ConvolutionOptions& options, float epsilon,
                                                   const TensorShape& input, const Engine& engine) {
  return std::make_unique<NormalisedConvolution>(options, epsilon, input, engine);
}

}  // namespace hqslam::nn
