#include <array>
#include <cmath>

#include "hqslam/core/error.h"
#include "kernels/attention_kernels.h"
#include "layers.h"

namespace hqslam::nn {
namespace {

constexpr int kPixels = kernels::kWindowPixels;
static_assert(kPixels == kWindowRows * kWindowColumns);
constexpr int kPairs = kPixels * kPixels;
/// Of one pixel of a window relative to another.
constexpr int kPlaces = (2 * kWindowRows - 1) * (2 * kWindowColumns - 1);
constexpr int kGreatestDepth = 64;
/// Added to the score of two pixels that must not attend to each other.
constexpr float kUnseen = -100.0F;

/// A value of every channel of one head for each pixel of a window.
using HeadOfWindow = std::array<float, kGreatestDepth * kPixels>;

class WindowAttention final : public TrainableLayer {
 public:
  WindowAttention(const WindowAttentionOptions& options, const TensorShape& input,
                  const Engine& engine)
      : TrainableLayer({input.channels / 3, input.rows, input.columns, input.padding}),
        options_(options),
        depth_(output_.channels / options.heads),
        shift_rows_(options.shifted ? kWindowRows / 2 : 0),
        shift_columns_(options.shifted ? kWindowColumns / 2 : 0),
        window_rows_(input.rows / kWindowRows),
        window_columns_(input.columns / kWindowColumns),
        kernels_(&kernels::attention_kernels(engine.instruction_set)) {
    if (depth_ * options.heads * 3 != input.channels || depth_ % 4 != 0 ||
        depth_ > kGreatestDepth || window_rows_ * kWindowRows != input.rows ||
        window_columns_ * kWindowColumns != input.columns) {
      throw Error(
          "attention: {} heads for {} channels, {} rows, {} columns, expected windows of {} x {} "
          "that divide rows and columns, and heads of 4, 8, ... {} channels",
          options.heads, output_.channels, input.rows, input.columns, kWindowRows, kWindowColumns,
          kGreatestDepth);
    }
  }

  /// Scores, and sums of values.
  std::int64_t multiply_adds() const override {
    return 2LL * kPixels * output_.channels * output_.rows * output_.columns;
  }

  std::vector<ParameterShape> parameter_shapes() const override {
    return {{"relative_position_bias_table", {kPlaces, options_.heads}}};
  }

  void add_initial_parameters(UniformStart& start, std::vector<float>& parameters) const override {
    start.add(static_cast<std::int64_t>(kPlaces) * options_.heads, 0.02F * std::sqrt(3.0F),
              parameters);
  }

  void set_parameters(std::span<const float> parameters) override {
    for (int kind = 0; kind < kWindowKinds; ++kind) {
      biases_[kind].resize(static_cast<std::size_t>(options_.heads) * kPairs);
      for (int head = 0; head < options_.heads; ++head) {
        for (int key = 0; key < kPixels; ++key) {
          for (int query = 0; query < kPixels; ++query) {
            biases_[kind][head * kPairs + key * kPixels + query] =
                parameters[place(query, key) * options_.heads + head] +
                (unseen(kind, query, key) ? kUnseen : 0.0F);
          }
        }
      }
    }
  }

  void forward(const LayerPass& pass) override {
#pragma omp for schedule(static)
    for (int task = 0; task < window_rows_ * options_.heads; ++task) {
      const int head = task % options_.heads;
      const int row = task / options_.heads;
      for (int column = 0; column < window_columns_; ++column) {
        HeadWindow work;
        attend({row, column, head}, *pass.input, work);
        scatter(work.output, {row, column, head}, 0, *pass.output,
                [](float& to, float from) { to = from; });
      }
      for (int channel = head * depth_; channel < (head + 1) * depth_; ++channel) {
        for (int r = 0; r < kWindowRows; ++r) {
          pass.output->fill_border(channel, image_row(row, r));
        }
      }
    }
  }

  void backward(std::span<const BackwardPass> batch, std::span<float> d_parameters) override {
    const auto add = [](float& to, float from) { to += from; };
    const float scale = query_scale();
    for (int head = 0; head < options_.heads; ++head) {
      std::array<float, kPairs> d_bias{};
      for (const BackwardPass& pass : batch) {
        for (int window = 0; window < window_rows_ * window_columns_; ++window) {
          const Place place{window / window_columns_, window % window_columns_, head};
          HeadWindow work;
          const kernels::AttentionWindow forward = attend(place, *pass.input, work);
          HeadOfWindow d_output;
          HeadOfWindow d_queries;
          HeadOfWindow d_keys;
          HeadOfWindow d_values;
          gather(*pass.d_output, place, 0, 1.0F, d_output);
          kernels_->attend_backward({forward, d_output.data(), d_queries.data(), d_keys.data(),
                                     d_values.data(), d_bias.data()});
          for (float& d : d_queries) d *= scale;
          scatter(d_queries, place, 0, *pass.d_input, add);
          scatter(d_keys, place, output_.channels, *pass.d_input, add);
          scatter(d_values, place, 2 * output_.channels, *pass.d_input, add);
        }
      }
      for (int key = 0; key < kPixels; ++key) {
        for (int query = 0; query < kPixels; ++query) {
          d_parameters[place(query, key) * options_.heads + head] += d_bias[key * kPixels + query];
        }
      }
    }
  }

 private:
  /// Windows in the middle, in the last row of windows, in the last column of windows, in both.
  static constexpr int kWindowKinds = 4;

  struct Place {
    int row = 0;  ///< of windows
    int column = 0;
    int head = 0;
  };
  struct HeadWindow {
    HeadOfWindow queries;
    HeadOfWindow keys;
    HeadOfWindow values;
    HeadOfWindow output;
    alignas(64) std::array<float, kPairs> probabilities;
  };

  float query_scale() const { return 1.0F / std::sqrt(static_cast<float>(depth_)); }
  /// The place of a query relative to a key.
  int place(int query, int key) const {
    const int down = query / kWindowColumns - key / kWindowColumns + kWindowRows - 1;
    const int right = query % kWindowColumns - key % kWindowColumns + kWindowColumns - 1;
    return down * (2 * kWindowColumns - 1) + right;
  }
  /// Whether two pixels of a window that goes on at the other end are from different ends.
  bool unseen(int kind, int a, int b) const {
    const auto beyond_row = [&](int pixel) {
      return pixel / kWindowColumns >= kWindowRows - shift_rows_;
    };
    const auto beyond_column = [&](int pixel) {
      return pixel % kWindowColumns >= kWindowColumns - shift_columns_;
    };
    return ((kind & 1) != 0 && beyond_row(a) != beyond_row(b)) ||
           ((kind & 2) != 0 && !options_.circular && beyond_column(a) != beyond_column(b));
  }
  int image_row(int window_row, int r) const {
    return (window_row * kWindowRows + r + shift_rows_) % output_.rows;
  }

  /// work(number in the window, row, column of the image) of each pixel.
  template <typename Work>
  void for_each_pixel(const Place& at, const Work& work) const {
    for (int r = 0; r < kWindowRows; ++r) {
      const int y = image_row(at.row, r);
      int x = at.column * kWindowColumns + shift_columns_;
      for (int c = 0; c < kWindowColumns; ++c, ++x) {
        if (x == output_.columns) x = 0;
        work(r * kWindowColumns + c, y, x);
      }
    }
  }

  void gather(const Tensor& from, const Place& at, int first_channel, float scale,
              HeadOfWindow& to) const {
    first_channel += at.head * depth_;
    for_each_pixel(at, [&](int pixel, int y, int x) {
      const float* value = from.row(first_channel, y) + x;
      for (int d = 0; d < depth_; ++d) {
        to[d * kPixels + pixel] = scale * value[d * from.channel_stride()];
      }
    });
  }

  template <typename Put>
  void scatter(const HeadOfWindow& from, const Place& at, int first_channel, Tensor& to,
               const Put& put) const {
    first_channel += at.head * depth_;
    for_each_pixel(at, [&](int pixel, int y, int x) {
      float* value = to.row(first_channel, y) + x;
      for (int d = 0; d < depth_; ++d) {
        put(value[d * to.channel_stride()], from[d * kPixels + pixel]);
      }
    });
  }

  kernels::AttentionWindow attend(const Place& at, const Tensor& input, HeadWindow& work) const {
    gather(input, at, 0, query_scale(), work.queries);
    gather(input, at, output_.channels, 1.0F, work.keys);
    gather(input, at, 2 * output_.channels, 1.0F, work.values);
    const int kind =
        (at.row + 1 == window_rows_ ? 1 : 0) + (at.column + 1 == window_columns_ ? 2 : 0);
    const kernels::AttentionWindow window{.depth = depth_,
                                          .queries = work.queries.data(),
                                          .keys = work.keys.data(),
                                          .values = work.values.data(),
                                          .bias = &biases_[kind][at.head * kPairs],
                                          .probabilities = work.probabilities.data(),
                                          .output = work.output.data()};
    kernels_->attend(window);
    return window;
  }

  WindowAttentionOptions options_;
  int depth_;
  int shift_rows_;
  int shift_columns_;
  int window_rows_;     ///< rows of windows
  int window_columns_;  ///< columns of windows
  const kernels::AttentionKernels* kernels_;
  std::array<std::vector<float>, kWindowKinds> biases_;  ///< head x key x query
};

}  // namespace

std::unique_ptr<Layer> make_window_attention(const WindowAttentionOptions& options,
                                             const TensorShape& input, const Engine& engine) {
  return std::make_unique<WindowAttention>(options, input, engine);
}

}  // namespace hqslam::nn
