#include "dropout.h"

#include <algorithm>

namespace hqslam::nn {
namespace {

class Dropout final : public Layer {
 public:
  Dropout(float share, const TensorShape& input) : Layer(input), share_(share) {}

  bool is_random() const override { return share_ > 0.0F; }

  void forward(const LayerPass& pass) override {
#pragma omp for schedule(static)
    for (int channel = 0; channel < output_.channels; ++channel) {
      for (int y = 0; y < output_.rows; ++y) {
        const float* from = pass.inputs[0]->row(channel, y);
        float* to = pass.output->row(channel, y);
        if (pass.seed) {
          for (int x = 0; x < output_.columns; ++x) to[x] = from[x] * factor(pass, channel, y, x);
        } else {
          std::copy_n(from, output_.columns, to);
        }
        pass.output->fill_border(channel, y);
      }
    }
  }

  void backward(std::span<const LayerPass> batch, std::span<float> /*d_parameters*/) override {
    for (const LayerPass& pass : batch) {
      for (int channel = 0; channel < output_.channels; ++channel) {
        for (int y = 0; y < output_.rows; ++y) {
          const float* d_output = pass.d_output->row(channel, y);
          float* d = pass.d_inputs[0]->row(channel, y);
          for (int x = 0; x < output_.columns; ++x) {
            d[x] += pass.seed ? d_output[x] * factor(pass, channel, y, x) : d_output[x];
          }
        }
      }
    }
  }

 private:
  float factor(const LayerPass& pass, int channel, int y, int x) const {
    const auto place = static_cast<std::uint64_t>(channel * output_.rows + y) *
                           static_cast<std::uint64_t>(output_.columns) +
                       static_cast<std::uint64_t>(x);
    return unit_random(*pass.seed, place) < share_ ? 0.0F : 1.0F / (1.0F - share_);
  }

  float share_;
};

}  // namespace

std::unique_ptr<Layer> make_dropout(float share, const TensorShape& input) {
  return std::make_unique<Dropout>(share, input);
}

}  // namespace hqslam::nn
