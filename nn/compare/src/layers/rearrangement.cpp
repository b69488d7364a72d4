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

/// Moves values between patches of pixels and channels: from pixels to channels if it merges,
/// otherwise from channels to pixels. `channel_of` has the channel of each pixel of a patch.
class PatchesAndChannels final : public TrainableLayer {
 public:
  PatchesAndChannels(bool merges, int factor, const TensorShape& input)
      : TrainableLayer(merges ? TensorShape{input.channels * factor * factor, input.rows / factor,
                                            input.columns / factor, input.padding}
                              : TensorShape{input.channels / (factor * factor), input.rows * factor,
                                            input.columns * factor, input.padding}),
        merges_(merges),
        factor_(factor) {}

  void forward(const LayerPass& pass) override {
    const int rows = merges_ ? pass.input->rows() : output_.rows;
#pragma omp for schedule(static)
    for (int y = 0; y < rows; ++y) {
      move_row(merges_, y, *pass.input, *pass.output, [](float& to, float from) { to = from; });
    }
#pragma omp for schedule(static)
    for (int channel = 0; channel < output_.channels; ++channel) {
      for (int y = 0; y < output_.rows; ++y) pass.output->fill_border(channel, y);
    }
  }

  void backward_scan(const BackwardPass& pass, std::span<float> /*d_parameters*/) override {
    const bool merges = !merges_;
    const int rows = merges ? pass.d_output->rows() : pass.d_input->rows();
    for (int y = 0; y < rows; ++y) {
      move_row(merges, y, *pass.d_output, *pass.d_input, [](float& to, float from) { to += from; });
    }
  }

 private:
  /// The channel of row i, column j of a patch of `channel`, one of `channels`.
  int channel_of(int channels, int channel, int i, int j) const {
    return merges_ ? (j * factor_ + i) * channels + channel : (channel * factor_ + i) * factor_ + j;
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

  bool merges_;
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
  return std::make_unique<PatchesAndChannels>(true, 2, input);
}

std::unique_ptr<Layer> make_pixel_shuffle(int factor, const TensorShape& input) {
  return std::make_unique<PatchesAndChannels>(false, factor, input);
}

}  // namespace hqslam::nn
