#include "kernels/attention_kernels.h"
#include "layers.h"

namespace hqslam::nn {
namespace {

class Gelu final : public Layer {
 public:
  Gelu(const TensorShape& input, const Engine& engine)
      : Layer(input), kernels_(&kernels::attention_kernels(engine.instruction_set)) {}

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

  void backward(std::span<const BackwardPass> batch, std::span<float> /*d_parameters*/) override {
    for (const BackwardPass& pass : batch) {
      for (int channel = 0; channel < output_.channels; ++channel) {
        for (int y = 0; y < output_.rows; ++y) {
          kernels_->gelu({.input = pass.input->row(channel, y),
                          .output = pass.d_input->row(channel, y),
                          .d_output = pass.d_output->row(channel, y),
                          .columns = output_.columns});
        }
      }
    }
  }

 private:
  const kernels::AttentionKernels* kernels_;
};

}  // namespace

std::unique_ptr<Layer> make_gelu(const TensorShape& input, const Engine& engine) {
  return std::make_unique<Gelu>(input, engine);
}

}  // namespace hqslam::nn
