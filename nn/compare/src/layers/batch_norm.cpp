#include <algorithm>
#include <cmath>

#include "layers.h"

namespace hqslam::nn {
namespace {

class BatchNorm final : public TrainableLayer {
 public:
  BatchNorm(float negative_slope, const TensorShape& input)
      : TrainableLayer(input), negative_slope_(negative_slope) {}

  std::vector<ParameterShape> parameter_shapes() const override {
    const std::int64_t channels = output_.channels;
    return {{"weight", {channels}},
            {"bias", {channels}},
            {"running_mean", {channels}, true},
            {"running_var", {channels}, true}};
  }

  void add_initial_parameters(UniformStart& /*start*/,
                              std::vector<float>& parameters) const override {
    for (const float value : {1.0F, 0.0F, 0.0F, 1.0F}) {
      parameters.insert(parameters.end(), output_.channels, value);
    }
  }

  void set_parameters(std::span<const float> parameters) override {
    for (std::vector<float>* values : {&weight_, &bias_, &running_mean_, &running_variance_}) {
      const std::span<const float> array = take(parameters, output_.channels);
      values->assign(array.begin(), array.end());
    }
  }

  void forward(const LayerPass& pass) override {
    normalise(pass, running_mean_.data(), running_variance_.data());
  }

  float negative_slope() const override { return negative_slope_; }

  void forward_batch(std::span<const LayerPass> batch) override {
    find_statistics(batch);
    for (const LayerPass& pass : batch) normalise(pass, mean_.data(), variance_.data());
  }

  /// With n = (x - mean) / deviation and g the gradient before the activation, which is d_output:
  ///   d_weight = sum g n, d_bias = sum g,
  ///   d_x = weight / deviation (g - mean(g) - n mean(g n)),
  /// because mean and deviation depend on every x of the batch.
  void backward(std::span<const BackwardPass> batch, std::span<float> d_parameters) override {
    const int channels = output_.channels;
    const std::span<float> d_weight = take(d_parameters, channels);
    const std::span<float> d_bias = take(d_parameters, channels);
    const std::span<float> d_mean = take(d_parameters, channels);
    const std::span<float> d_variance = take(d_parameters, channels);
    const auto scans = static_cast<float>(batch.size());
    const double pixels = pixels_of(batch.size());
    for (int channel = 0; channel < channels; ++channel) {
      const float mean = mean_[channel];
      const float inverse = 1.0F / std::sqrt(variance_[channel] + kBatchNormEpsilon);
      double sum = 0.0;
      double sum_normal = 0.0;
      for_each_row(batch, [&](const BackwardPass& pass, int y) {
        const float* x = pass.input->row(channel, y);
        const float* g = pass.d_output->row(channel, y);
        float row_sum = 0.0F;
        float row_normal = 0.0F;
        for (int i = 0; i < output_.columns; ++i) {
          row_sum += g[i];
          row_normal += g[i] * (x[i] - mean);
        }
        sum += row_sum;
        sum_normal += row_normal * inverse;
      });
      d_weight[channel] += static_cast<float>(sum_normal);
      d_bias[channel] += static_cast<float>(sum);
      d_mean[channel] += scans * (running_mean_[channel] - mean);
      const double unbiased = variance_[channel] * pixels / std::max(1.0, pixels - 1.0);
      d_variance[channel] += scans * (running_variance_[channel] - static_cast<float>(unbiased));
      const auto mean_g = static_cast<float>(sum / pixels);
      const auto mean_normal = static_cast<float>(sum_normal / pixels);
      const float scale = weight_[channel] * inverse;
      for_each_row(batch, [&](const BackwardPass& pass, int y) {
        const float* x = pass.input->row(channel, y);
        const float* g = pass.d_output->row(channel, y);
        float* d_x = pass.d_input->row(channel, y);
        for (int i = 0; i < output_.columns; ++i) {
          const float normal = (x[i] - mean) * inverse;
          d_x[i] += scale * (g[i] - mean_g - normal * mean_normal);
        }
      });
    }
  }

 private:
  template <typename Pass, typename Work>
  void for_each_row(std::span<const Pass> batch, const Work& work) const {
    for (const Pass& pass : batch) {
      for (int y = 0; y < output_.rows; ++y) work(pass, y);
    }
  }
  double pixels_of(std::size_t scans) const {
    return static_cast<double>(scans) * output_.rows * output_.columns;
  }

  void find_statistics(std::span<const LayerPass> batch) {
    mean_.resize(output_.channels);
    variance_.resize(output_.channels);
    for (int channel = 0; channel < output_.channels; ++channel) {
      const auto mean_over = [&](const auto& term) {
        double sum = 0.0;
        for_each_row(batch, [&](const LayerPass& pass, int y) {
          const float* x = pass.input->row(channel, y);
          float of_row = 0.0F;
          for (int i = 0; i < output_.columns; ++i) of_row += term(x[i]);
          sum += of_row;
        });
        return static_cast<float>(sum / pixels_of(batch.size()));
      };
      const float mean = mean_over([](float x) { return x; });
      mean_[channel] = mean;
      variance_[channel] = mean_over([&](float x) { return (x - mean) * (x - mean); });
    }
  }

  void normalise(const LayerPass& pass, const float* mean, const float* variance) const {
#pragma omp for schedule(static)
    for (int channel = 0; channel < output_.channels; ++channel) {
      const float scale = weight_[channel] / std::sqrt(variance[channel] + kBatchNormEpsilon);
      for (int y = 0; y < output_.rows; ++y) {
        const float* x = pass.input->row(channel, y);
        float* output = pass.output->row(channel, y);
        for (int i = 0; i < output_.columns; ++i) {
          const float v = (x[i] - mean[channel]) * scale + bias_[channel];
          output[i] = std::max(v, negative_slope_ * v);
        }
        pass.output->fill_border(channel, y);
      }
    }
  }

  float negative_slope_;
  std::vector<float> weight_;
  std::vector<float> bias_;
  std::vector<float> running_mean_;
  std::vector<float> running_variance_;
  std::vector<float> mean_;  ///< of the batch
  std::vector<float> variance_;
};

}  // namespace

std::unique_ptr<Layer> make_batch_norm(float negative_slope, const TensorShape& input) {
  return std::make_unique<BatchNorm>(negative_slope, input);
}

}  // namespace hqslam::nn
