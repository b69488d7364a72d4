#include "layers.h"

// Layers without parameters.
namespace hqslam::nn {
namespace {

class AveragePool final : public TrainableLayer {
 public:
  explicit AveragePool(const TensorShape& input)
      : TrainableLayer({input.channels, input.rows / 2, input.columns / 2, input.padding}) {}

  void forward(const LayerPass& pass) override {
#pragma omp for schedule(static)
    for (int channel = 0; channel < output_.channels; ++channel) {
      for (int y = 0; y < output_.rows; ++y) {
        const float* upper = pass.input->row(channel, 2 * y);
        const float* lower = pass.input->row(channel, 2 * y + 1);
        float* mean = pass.output->row(channel, y);
        for (int x = 0; x < output_.columns; ++x) {
          mean[x] = 0.25F * (upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1]);
        }
        pass.output->fill_border(channel, y);
      }
    }
  }

  void backward_scan(const BackwardPass& pass, std::span<float> /*d_parameters*/) override {
    for (int channel = 0; channel < output_.channels; ++channel) {
      for (int y = 0; y < 2 * output_.rows; ++y) {
        const float* d_mean = pass.d_output->row(channel, y / 2);
        float* d = pass.d_input->row(channel, y);
        for (int x = 0; x < 2 * output_.columns; ++x) d[x] += 0.25F * d_mean[x / 2];
      }
    }
  }
};

class Concatenation final : public TrainableLayer {
 public:
  Concatenation(const TensorShape& first, const TensorShape& second)
      : TrainableLayer(
            {first.channels + second.channels, first.rows, first.columns, first.padding}) {}

  void forward(const LayerPass& pass) override {
    const int of_first = pass.input->channels();
    copy_channels(*pass.input, 0, of_first, *pass.output, 0);
    copy_channels(*pass.second, 0, pass.second->channels(), *pass.output, of_first);
  }

  void backward_scan(const BackwardPass& pass, std::span<float> /*d_parameters*/) override {
    add_channels(*pass.d_output, 0, *pass.d_input);
    add_channels(*pass.d_output, pass.d_input->channels(), *pass.d_second);
  }
};

}  // namespace

std::unique_ptr<Layer> make_average_pool(const TensorShape& input) {
  return std::make_unique<AveragePool>(input);
}

std::unique_ptr<Layer> make_concatenation(const TensorShape& first, const TensorShape& second) {
  return std::make_unique<Concatenation>(first, second);
}

}  // namespace hqslam::nn
