#include "layers.h"

// Layers without parameters: pixels and channels rearranged, side by side, or averaged.
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

  void backward(std::span<const BackwardPass> batch, std::span<float> /*d_parameters*/) override {
    for (const BackwardPass& pass : batch) {
      add_channels(*pass.d_output, 0, *pass.d_input);
      add_channels(*pass.d_output, pass.d_input->channels(), *pass.d_second);
    }
  }
};

/// Moves values between patches of pixels and channels; which channel is which pixel of the patch,
/// `channel_of` says.
class PatchesAndChannels final : public TrainableLayer {
 public:
  /// Merging: pixels -> channels; otherwise channels -> pixels.
  enum class Direction { kMerge, kShuffle };
  PatchesAndChannels(Direction direction, int factor, const TensorShape& input)
      : TrainableLayer(direction == Direction::kMerge
                           ? TensorShape{input.channels * factor * factor, input.rows / factor,
                                         input.columns / factor, input.padding}
                           : TensorShape{input.channels / (factor * factor), input.rows * factor,
                                         input.columns * factor, input.padding}),
        direction_(direction),
        factor_(factor) {}

  void forward(const LayerPass& pass) override {
    const bool merges = direction_ == Direction::kMerge;
    const int rows = merges ? pass.input->rows() : output_.rows;
#pragma omp for schedule(static)
    for (int y = 0; y < rows; ++y) {
      move_row(merges, y, *pass.input, *pass.output, [](float& to, float from) { to = from; });
    }
#pragma omp for schedule(static)
    for (int channel = 0; channel < output_.channels; ++channel) {
      for (int y = 0; y < output_.rows; ++y) pass.output->fill_border(channel, y);
    }
  }

  void backward(std::span<const BackwardPass> batch, std::span<float> /*d_parameters*/) override {
    const bool merges = direction_ == Direction::kShuffle;  // the other way
    for (const BackwardPass& pass : batch) {
      const int rows = merges ? pass.d_output->rows() : pass.d_input->rows();
      for (int y = 0; y < rows; ++y) {
        move_row(merges, y, *pass.d_output, *pass.d_input,
                 [](float& to, float from) { to += from; });
      }
    }
  }

 private:
  /// The channel of row i, column j of a patch of `channel`, one of `channels`.
  int channel_of(int channels, int channel, int i, int j) const {
    return direction_ == Direction::kMerge ? (j * factor_ + i) * channels + channel
                                           : (channel * factor_ + i) * factor_ + j;
  }
  /// What row y of the pixels and its part of the channels have in common, from either to the
  /// other.
  template <typename Put>
  void move_row(bool merges, int y, const Tensor& from, Tensor& to, const Put& put) const {
    const int channels = merges ? from.channels() : to.channels();
    const int patches = merges ? to.columns() : from.columns();
    for (int channel = 0; channel < channels; ++channel) {
      for (int j = 0; j < factor_; ++j) {
        const int other = channel_of(channels, channel, y % factor_, j);
        const float* source = merges ? from.row(channel, y) + j : from.row(other, y / factor_);
        float* target = merges ? to.row(other, y / factor_) : to.row(channel, y) + j;
        for (int x = 0; x < patches; ++x) {
          put(target[merges ? x : x * factor_], source[merges ? x * factor_ : x]);
        }
      }
    }
  }

  Direction direction_;
  int factor_;
};

}  // namespace

std::unique_ptr<Layer> make_average_pool(const TensorShape& input) {
  return std::make_unique<AveragePool>(input);
}

std::unique_ptr<Layer> make_concatenation(const TensorShape& first, const TensorShape& second) {
  return std::make_unique<Concatenation>(first, second);
}

std::unique_ptr<Layer> make_patch_merging(const TensorShape& input) {
  return std::make_unique<PatchesAndChannels>(PatchesAndChannels::Direction::kMerge, 2, input);
}

std::unique_ptr<Layer> make_pixel_shuffle(int factor, const TensorShape& input) {
  return std::make_unique<PatchesAndChannels>(PatchesAndChannels::Direction::kShuffle, factor,
                                              input);
}

}  // namespace hqslam::nn
