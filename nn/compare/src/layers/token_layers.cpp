#include <algorithm>
#include <cmath>

#include "kernels/attention_kernels.h"
#include "layers.h"

// The layers of a transformer beside its attention.
namespace hqslam::nn {
namespace {

class LayerNorm final : public TrainableLayer {
 public:
  explicit LayerNorm(const TensorShape& input)
      : TrainableLayer(input), of_pixel_(4, input.rows, input.columns, input.padding) {}

  std::vector<ParameterShape> parameter_shapes() const override {
    return {{"weight", {output_.channels}}, {"bias", {output_.channels}}};
  }

  void add_initial_parameters(UniformStart& /*start*/,
                              std::vector<float>& parameters) const override {
    parameters.insert(parameters.end(), output_.channels, 1.0F);
    parameters.insert(parameters.end(), output_.channels, 0.0F);
  }

  void set_parameters(std::span<const float> parameters) override {
    const std::span<const float> weight = take(parameters, output_.channels);
    weight_.assign(weight.begin(), weight.end());
    bias_.assign(parameters.begin(), parameters.end());
  }

  void forward(const LayerPass& pass) override {
#pragma omp for schedule(static)
    for (int y = 0; y < output_.rows; ++y) {
      find_statistics(*pass.input, y);
      const float* mean = of_pixel_.row(kMean, y);
      const float* inverse = of_pixel_.row(kInverseDeviation, y);
      for (int channel = 0; channel < output_.channels; ++channel) {
        const float* from = pass.input->row(channel, y);
        float* to = pass.output->row(channel, y);
        for (int x = 0; x < output_.columns; ++x) {
          to[x] = (from[x] - mean[x]) * inverse[x] * weight_[channel] + bias_[channel];
        }
        pass.output->fill_border(channel, y);
      }
    }
  }

  /// As batch norm's (batch_norm.cpp), over the channels of each pixel.
  void backward_scan(const BackwardPass& pass, std::span<float> d_parameters) override {
    const std::span<float> d_weight = take(d_parameters, output_.channels);
    for (int y = 0; y < output_.rows; ++y) backward_row(pass, y, d_weight, d_parameters);
  }

 private:
  enum OfPixel { kMean, kInverseDeviation, kMeanGradient, kMeanNormal };

  void find_statistics(const Tensor& input, int y) {
    const int columns = output_.columns;
    const float share = 1.0F / static_cast<float>(output_.channels);
    float* mean = of_pixel_.row(kMean, y);
    float* inverse = of_pixel_.row(kInverseDeviation, y);
    std::fill_n(mean, columns, 0.0F);
    std::fill_n(inverse, columns, 0.0F);
    for (int channel = 0; channel < output_.channels; ++channel) {
      const float* from = input.row(channel, y);
      for (int x = 0; x < columns; ++x) mean[x] += share * from[x];
    }
    for (int channel = 0; channel < output_.channels; ++channel) {
      const float* from = input.row(channel, y);
      for (int x = 0; x < columns; ++x) {
        inverse[x] += share * (from[x] - mean[x]) * (from[x] - mean[x]);
      }
    }
    for (int x = 0; x < columns; ++x) inverse[x] = 1.0F / std::sqrt(inverse[x] + kLayerNormEpsilon);
  }

  void backward_row(const BackwardPass& pass, int y, std::span<float> d_weight,
                    std::span<float> d_bias) {
    const int columns = output_.columns;
    const float share = 1.0F / static_cast<float>(output_.channels);
    find_statistics(*pass.input, y);
    const float* mean = of_pixel_.row(kMean, y);
    const float* inverse = of_pixel_.row(kInverseDeviation, y);
    float* mean_gradient = of_pixel_.row(kMeanGradient, y);
    float* mean_normal = of_pixel_.row(kMeanNormal, y);
    std::fill_n(mean_gradient, columns, 0.0F);
    std::fill_n(mean_normal, columns, 0.0F);
    for (int channel = 0; channel < output_.channels; ++channel) {
      const float* from = pass.input->row(channel, y);
      const float* d_output = pass.d_output->row(channel, y);
      const float weight = share * weight_[channel];
      float sum = 0.0F;
      float sum_normal = 0.0F;
      for (int x = 0; x < columns; ++x) {
        const float normal = (from[x] - mean[x]) * inverse[x];
        mean_gradient[x] += weight * d_output[x];
        mean_normal[x] += weight * d_output[x] * normal;
        sum += d_output[x];
        sum_normal += d_output[x] * normal;
      }
      d_weight[channel] += sum_normal;
      d_bias[channel] += sum;
    }
    for (int channel = 0; channel < output_.channels; ++channel) {
      const float* from = pass.input->row(channel, y);
      const float* d_output = pass.d_output->row(channel, y);
      float* d_input = pass.d_input->row(channel, y);
      for (int x = 0; x < columns; ++x) {
        const float normal = (from[x] - mean[x]) * inverse[x];
        d_input[x] += inverse[x] *
                      (weight_[channel] * d_output[x] - mean_gradient[x] - normal * mean_normal[x]);
      }
    }
  }

  Tensor of_pixel_;
  std::vector<float> weight_;
  std::vector<float> bias_;
};

class Gelu final : public TrainableLayer {
 public:
  Gelu(const TensorShape& input, const Engine& engine)
      : TrainableLayer(input), kernels_(&kernels::attention_kernels(engine.instruction_set)) {}

  void forward(const LayerPass& pass) override {
#pragma omp for schedule(static)
    for (int channel = 0; channel < output_.channels; ++channel) {
      for (int y = 0; y < output_.rows; ++y) {
        kernels_->gelu({.input = pass.input->row(channel, y),
                        .output = pass.output->row(channel, y),
                        .columns = output_.columns});
        pass.output->fill_border(channel, y);
      }
    }
  }

  void backward_scan(const BackwardPass& pass, std::span<float> /*d_parameters*/) override {
    for (int channel = 0; channel < output_.channels; ++channel) {
      for (int y = 0; y < output_.rows; ++y) {
        kernels_->gelu({.input = pass.input->row(channel, y),
                        .output = pass.d_input->row(channel, y),
                        .d_output = pass.d_output->row(channel, y),
                        .columns = output_.columns});
      }
    }
  }

 private:
  const kernels::AttentionKernels* kernels_;
};

}  // namespace

std::unique_ptr<Layer> make_layer_norm(const TensorShape& input) {
  return std::make_unique<LayerNorm>(input);
}

std::unique_ptr<Layer> make_gelu(const TensorShape& input, const Engine& engine) {
  return std::make_unique<Gelu>(input, engine);
}

namespace kernels {

const AttentionKernels& attention_kernels(InstructionSet instruction_set) {
#ifdef HQSLAM_X86_KERNELS
  if (instruction_set == InstructionSet::kAvx512) return kAvx512Attention;
  if (instruction_set == InstructionSet::kAvx2) return kAvx2Attention;
#endif
  static_cast<void>(instruction_set);
  return kPortableAttention;
}

}  // namespace kernels
}  // namespace hqslam::nn
