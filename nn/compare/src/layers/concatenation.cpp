#include <algorithm>

#include "layers.h"

namespace hqslam::nn {
namespace {

class Concatenation final : public Layer {
 public:
  Concatenation(const TensorShape& first, const TensorShape& second)
      : Layer({first.channels + second.channels, first.rows, first.columns, first.padding}) {}

  void forward(const LayerPass& pass) override {
    const int of_first = pass.inputs[0]->channels();
#pragma omp for schedule(static)
    for (int channel = 0; channel < output_.channels; ++channel) {
      const bool in_first = channel < of_first;
      const Tensor& from = *pass.inputs[in_first ? 0 : 1];
      for (int y = 0; y < output_.rows; ++y) {
        std::copy_n(from.row(in_first ? channel : channel - of_first, y), output_.columns,
                    pass.output->row(channel, y));
        pass.output->fill_border(channel, y);
      }
    }
  }

  void backward(std::span<const LayerPass> batch, std::span<float> /*d_parameters*/) override {
    for (const LayerPass& pass : batch) {
      int channel = 0;
      for (Tensor* d_input : pass.d_inputs) {
        for (int to = 0; to < d_input->channels(); ++to, ++channel) {
          for (int y = 0; y < output_.rows; ++y) {
            const float* d_output = pass.d_output->row(channel, y);
            float* d = d_input->row(to, y);
            for (int x = 0; x < output_.columns; ++x) d[x] += d_output[x];
          }
        }
      }
    }
  }
};

}  // namespace

std::unique_ptr<Layer> make_concatenation(const TensorShape& first, const TensorShape& second) {
  return std::make_unique<Concatenation>(first, second);
}

}  // namespace hqslam::nn
