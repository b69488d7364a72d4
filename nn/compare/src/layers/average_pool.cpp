#include "layers.h"

namespace hqslam::nn {
namespace {

class AveragePool final : public Layer {
 public:
  explicit AveragePool(const TensorShape& input)
      : Layer({input.channels, input.rows / 2, input.columns / 2, input.padding}) {}

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

  void backward(std::span<const BackwardPass> batch, std::span<float> /*d_parameters*/) override {
    for (const BackwardPass& pass : batch) {
      Tensor& d_input = *pass.d_input;
      for (int channel = 0; channel < output_.channels; ++channel) {
        for (int y = 0; y < d_input.rows() / 2 * 2; ++y) {
          const float* d_mean = pass.d_output->row(channel, y / 2);
          float* d = d_input.row(channel, y);
          for (int x = 0; x < 2 * output_.columns; ++x) d[x] += 0.25F * d_mean[x / 2];
        }
      }
    }
  }
};

}  // namespace

std::unique_ptr<Layer> make_average_pool(const TensorShape& input) {
  return std::make_unique<AveragePool>(input);
}

}  // namespace hqslam::nn
