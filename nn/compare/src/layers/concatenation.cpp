#include <algorithm>

#include "graph/tensor_sums.h"
#include "layers.h"

namespace hqslam::nn {
namespace {

class Concatenation final : public Layer {
 public:
  Concatenation(const TensorShape& first, const TensorShape& second)
      : Layer({first.channels + second.channels, first.rows, first.columns, first.padding}) {}

  void forward(const LayerPass& pass) override {
    const int of_first = pass.input->channels();
#pragma omp for schedule(static)
    for (int channel = 0; channel < output_.channels; ++channel) {
      const bool in_first = channel < of_first;
      const Tensor& from = in_first ? *pass.input : *pass.second;
      for (int y = 0; y < output_.rows; ++y) {
        std::copy_n(from.row(in_first ? channel : channel - of_first, y), output_.columns,
                    pass.output->row(channel, y));
        pass.output->fill_border(channel, y);
      }
    }
  }

  void backward(std::span<const BackwardPass> batch, std::span<float> /*d_parameters*/) override {
    for (const BackwardPass& pass : batch) {
      add_channels(*pass.d_output, 0, *pass.d_input);
      add_channels(*pass.d_output, pass.d_input->channels(), *pass.d_second);
    }
  }
};

}  // namespace

std::unique_ptr<Layer> make_concatenation(const TensorShape& first, const TensorShape& second) {
  return std::make_unique<Concatenation>(first, second);
}

}  // namespace hqslam::nn
