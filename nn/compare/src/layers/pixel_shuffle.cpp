#include "layers.h"

namespace hqslam::nn {
namespace {

/// Moves values between patches of pixels and channels; which channel is which pixel of the patch,
/// `channel_of` says.
class PatchesAndChannels final : public Layer {
 public:
  /// Merging: pixels -> channels; otherwise channels -> pixels.
  enum class Direction { kMerge, kShuffle };
  PatchesAndChannels(Direction direction, int factor, const TensorShape& input)
      : Layer(direction == Direction::kMerge
                  ? TensorShape{input.channels * factor * factor, input.rows / factor,
                                input.columns / factor, input.padding}
                  : TensorShape{input.channels / (factor * factor), input.rows * factor,
                                input.columns * factor, input.padding}),
        direction_(direction),
        factor_(factor) {}

  void forward(const LayerPass& pass) override {
    const bool merge = direction_ == Direction::kMerge;
    const Tensor& pixels = merge ? *pass.input : *pass.output;
#pragma omp for schedule(static)
    for (int y = 0; y < pixels.rows(); ++y) {
      for (int channel = 0; channel < pixels.channels(); ++channel) {
        for (int j = 0; j < factor_; ++j) {
          const int other = channel_of(pixels.channels(), channel, y % factor_, j);
          if (merge) {
            const float* from = pass.input->row(channel, y) + j;
            float* to = pass.output->row(other, y / factor_);
            for (int x = 0; x < output_.columns; ++x) to[x] = from[x * factor_];
            pass.output->fill_border(other, y / factor_);
          } else {
            const float* from = pass.input->row(other, y / factor_);
            float* to = pass.output->row(channel, y) + j;
            for (int x = 0; x < pass.input->columns(); ++x) to[x * factor_] = from[x];
          }
        }
        if (!merge) pass.output->fill_border(channel, y);
      }
    }
  }

  void backward(std::span<const BackwardPass> batch, std::span<float> /*d_parameters*/) override {
    const bool merge = direction_ == Direction::kMerge;
    for (const BackwardPass& pass : batch) {
      Tensor& d_input = *pass.d_input;
      const Tensor& pixels = merge ? d_input : *pass.d_output;
      for (int channel = 0; channel < pixels.channels(); ++channel) {
        for (int y = 0; y < pixels.rows(); ++y) {
          for (int x = 0; x < pixels.columns(); ++x) {
            const int other = channel_of(pixels.channels(), channel, y % factor_, x % factor_);
            if (merge) {
              d_input.at(channel, y, x) += pass.d_output->at(other, y / factor_, x / factor_);
            } else {
              d_input.at(other, y / factor_, x / factor_) += pass.d_output->at(channel, y, x);
            }
          }
        }
      }
    }
  }

 private:
  /// Of row i, column j of a patch of `channel`, one of `channels`.
  int channel_of(int channels, int channel, int i, int j) const {
    return direction_ == Direction::kMerge ? (j * factor_ + i) * channels + channel
                                           : (channel * factor_ + i) * factor_ + j;
  }

  Direction direction_;
  int factor_;
};

}  // namespace

std::unique_ptr<Layer> make_patch_merging(const TensorShape& input) {
  return std::make_unique<PatchesAndChannels>(PatchesAndChannels::Direction::kMerge, 2, input);
}

std::unique_ptr<Layer> make_pixel_shuffle(int factor, const TensorShape& input) {
  return std::make_unique<PatchesAndChannels>(PatchesAndChannels::Direction::kShuffle, factor,
                                              input);
}

}  // namespace hqslam::nn
