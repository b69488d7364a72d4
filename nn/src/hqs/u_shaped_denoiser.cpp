#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "denoiser_layers.h"
#include "hqslam/core/error.h"
#include "hqslam/nn/activation.h"
#include "hqslam/nn/conv2d.h"
#include "hqslam/nn/conv_transpose2d.h"
#include "hqslam/nn/hqs/denoiser.h"

namespace hqslam::nn {
namespace {

/// In the order of their parameters: encoders (0 to levels - 1), bottleneck, decoders from the
/// lowest up, head. hidden[] has the same order without the head.
class UShapedDenoiser final : public Denoiser {
 public:
  UShapedDenoiser(const UShapedDenoiserShape& shape, int rows, int columns,
                  InstructionSet instruction_set, int threads);

  TileSize tile() const override { return shape_.tile; }
  ColumnPadding padding() const override { return ColumnPadding::kCircular; }
  int memory_channels() const override { return shape_.memory; }
  std::vector<ParameterShape> parameter_shapes() const override;
  std::vector<float> initial_parameters(std::uint64_t seed) const override;
  std::int64_t multiply_adds() const override;
  DenoiserState make_state(bool for_backward) const override;
  void set_parameters(std::span<const float> parameters) override;
  void forward(const Candidates& candidates, DenoiserState& state,
               std::optional<std::uint64_t> dropout_seed) override;
  void backward(const Candidates& candidates, const DenoiserState& state, DenoiserState& gradient,
                std::span<float> d_parameters) override;

 private:
  int levels() const { return static_cast<int>(shape_.channels.size()); }
  int scores() const { return kSelectionGroups * shape_.tile.pixels(); }
  Tensor level_tensor(int level, int channels) const;
  /// Head and selection one row after the other: the scores of a row never leave the cache. Leaves
  /// the memory and no weights.
  void select_by_row(const Candidates& candidates, DenoiserState& state);
  /// hidden[] of the decoder that gives level `level` (the lowest level has none).
  int decoder(int level) const { return 2 * levels() - 1 - level; }

  UShapedDenoiserShape shape_;
  int rows_;
  int columns_;
  InstructionSet instruction_set_;
  std::vector<Conv2d> encoders_;
  std::vector<Conv2d> bottleneck_and_head_;
  std::vector<ConvTranspose2d> decoders_;      ///< the lowest first
  std::vector<std::vector<float>> head_rows_;  ///< a row of the head's result, one per thread
};

void check_image(const UShapedDenoiserShape& shape, int rows, int columns) {
  const int halvings = 1 << (shape.channels.size() - 1);
  if (rows % (shape.tile.rows * halvings) != 0 || columns % (shape.tile.columns * halvings) != 0) {
    throw Error(fmt::format("denoiser: an image of {} x {}, expected multiples of {} x {}", rows,
                            columns, shape.tile.rows * halvings, shape.tile.columns * halvings));
  }
}

UShapedDenoiser::UShapedDenoiser(const UShapedDenoiserShape& shape, int rows, int columns,
                                 InstructionSet instruction_set, int threads)
    : shape_(shape), rows_(rows), columns_(columns), instruction_set_(instruction_set) {
  validate(shape);
  check_image(shape, rows, columns);
  const DenoiserState state = make_state(true);
  const auto conv = [&](const Tensor& from, const Tensor& to, int kernel, int stride) {
    return Conv2d({from.channels(), to.channels(), kernel, kernel, stride, kernel / 2, kernel / 2},
                  from, to, instruction_set, threads);
  };
  encoders_.push_back(conv(state.input, state.hidden[0], 3, 1));
  for (int level = 1; level < levels(); ++level) {
    encoders_.push_back(conv(state.hidden[level - 1], state.hidden[level], 3, 2));
  }
  bottleneck_and_head_.push_back(conv(state.hidden[levels() - 1], state.hidden[levels()], 3, 1));
  for (int level = levels() - 2; level >= 0; --level) {
    const Tensor& from = state.hidden[decoder(level) - 1];
    const Tensor& to = state.hidden[decoder(level)];
    decoders_.emplace_back(ConvolutionShape{from.channels(), to.channels(), 2, 2, 2, 0, 0}, from,
                           to, instruction_set, threads);
  }
  bottleneck_and_head_.push_back(conv(state.hidden.back(), state.output, 1, 1));
  head_rows_.assign(threads, std::vector<float>(static_cast<std::size_t>(state.output.channels()) *
                                                state.output.padded_columns()));
}

Tensor UShapedDenoiser::level_tensor(int level, int channels) const {
  return {channels, rows_ / shape_.tile.rows >> level, columns_ / shape_.tile.columns >> level,
          padding()};
}

DenoiserState UShapedDenoiser::make_state(bool for_backward) const {
  DenoiserState state;
  state.input = level_tensor(0, shape_.tile.pixels() + shape_.memory);
  for (int level = 0; level < levels(); ++level) {
    state.hidden.push_back(level_tensor(level, shape_.channels[level]));
  }
  for (int level = levels() - 1; level >= 0; --level) {
    state.hidden.push_back(level_tensor(level, shape_.channels[level]));
  }
  state.output =
      level_tensor(0, for_backward ? scores() + shape_.memory : std::max(1, shape_.memory));
  state.z = level_tensor(0, shape_.tile.pixels());
  return state;
}

std::vector<ParameterShape> UShapedDenoiser::parameter_shapes() const {
  std::vector<ParameterShape> shapes;
  const std::vector<int>& c = shape_.channels;
  const auto conv = [&](const std::string& name, int from, int to, int kernel) {
    add_convolution(name, {to, from, kernel, kernel}, to, shapes);
  };
  conv("encoder.0", shape_.tile.pixels() + shape_.memory, c[0], 3);
  for (int level = 1; level < levels(); ++level) {
    conv(fmt::format("encoder.{}", level), c[level - 1], c[level], 3);
  }
  conv("bottleneck", c.back(), c.back(), 3);
  for (int level = levels() - 2; level >= 0; --level) {
    add_convolution(fmt::format("decoder.{}", level), {c[level + 1], c[level], 2, 2}, c[level],
                    shapes);
  }
  conv("head", c[0], scores() + shape_.memory, 1);
  return shapes;
}

std::vector<float> UShapedDenoiser::initial_parameters(std::uint64_t seed) const {
  UniformStart start(seed);
  std::vector<float> parameters;
  for (const ParameterShape& shape : parameter_shapes()) {
    const bool head = shape.name.starts_with("head");
    if (shape.shape.size() == 4) {
      // PyTorch counts the fan-in of both kinds of convolution in the second extent.
      const std::int64_t fan_in = shape.elements() / shape.shape[0];
      start.add(shape.elements(), (head ? 0.1F : 1.0F) / std::sqrt(static_cast<float>(fan_in)),
                parameters);
    } else if (head) {
      // "Here" is the first choice, "nothing" the last.
      constexpr float kFirstScores[kSelectionGroups] = {0.0F, 0.0F, 0.5F, -0.25F, 0.0F};
      for (std::int64_t i = 0; i < shape.elements(); ++i) {
        parameters.push_back(i < scores() ? kFirstScores[i / shape_.tile.pixels()] : 0.0F);
      }
    } else {
      start.add(shape.elements(), 0.1F, parameters);
    }
  }
  return parameters;
}

std::int64_t UShapedDenoiser::multiply_adds() const {
  const DenoiserState state = make_state(true);
  const auto pixels = [](const Tensor& tensor) {
    return static_cast<std::int64_t>(tensor.rows()) * tensor.columns();
  };
  std::int64_t sum = 0;
  for (int level = 0; level < levels(); ++level) {
    sum += encoders_[level].shape().weights() * pixels(state.hidden[level]);
  }
  sum += bottleneck_and_head_[0].shape().weights() * pixels(state.hidden[levels()]);
  for (int level = levels() - 2; level >= 0; --level) {
    sum += decoders_[levels() - 2 - level].shape().weights() *
           pixels(state.hidden[decoder(level) - 1]);
  }
  return sum + bottleneck_and_head_[1].shape().weights() * pixels(state.output);
}

void UShapedDenoiser::set_parameters(std::span<const float> parameters) {
  check_parameters(parameters, parameter_shapes());
  const auto set = [&](auto& layer, int biases) {
    const std::span<const float> weight = take(parameters, layer.shape().weights());
    layer.set_parameters(weight, take(parameters, biases));
  };
  for (Conv2d& encoder : encoders_) set(encoder, encoder.shape().output_channels);
  set(bottleneck_and_head_[0], shape_.channels.back());
  for (ConvTranspose2d& layer : decoders_) set(layer, layer.shape().output_channels);
  set(bottleneck_and_head_[1], scores() + shape_.memory);
}

void UShapedDenoiser::forward(const Candidates& candidates, DenoiserState& state,
                              std::optional<std::uint64_t> /*dropout_seed*/) {
  const float slope = shape_.negative_slope;
  encoders_[0].forward(state.input, {slope}, state.hidden[0]);
  for (int level = 1; level < levels(); ++level) {
    encoders_[level].forward(state.hidden[level - 1], {slope}, state.hidden[level]);
  }
  bottleneck_and_head_[0].forward(state.hidden[levels() - 1], {slope}, state.hidden[levels()]);
  for (int level = levels() - 2; level >= 0; --level) {
    const int to = decoder(level);
    decoders_[levels() - 2 - level].forward(state.hidden[to - 1], {slope, &state.hidden[level]},
                                            state.hidden[to]);
  }
  if (state.output.channels() < scores() + shape_.memory) {
    select_by_row(candidates, state);
    return;
  }
  bottleneck_and_head_[1].forward(state.hidden.back(), {}, state.output);
  select(candidates, state.input, shape_.tile, instruction_set_, state.output, state.z);
}

void UShapedDenoiser::select_by_row(const Candidates& candidates, DenoiserState& state) {
  const std::int64_t stride = state.output.padded_columns();
#pragma omp for schedule(static)
  for (int row = 0; row < state.z.rows(); ++row) {
    float* scores_of_row = head_rows_[omp_get_thread_num()].data();
    bottleneck_and_head_[1].forward_row(state.hidden.back(), row, scores_of_row, stride);
    select_row(candidates, state.input, shape_.tile, instruction_set_, row, scores_of_row, stride,
               state.z);
    for (int channel = 0; channel < shape_.memory; ++channel) {
      std::copy_n(scores_of_row + (scores() + channel) * stride, state.output.columns(),
                  state.output.row(channel, row));
    }
  }
}

void UShapedDenoiser::backward(const Candidates& candidates, const DenoiserState& state,
                               DenoiserState& gradient, std::span<float> d_parameters) {
  std::vector<std::span<float>> d_arrays;
  for (const ParameterShape& shape : parameter_shapes()) {
    d_arrays.push_back(take(d_parameters, shape.elements()));
  }
  const float slope = shape_.negative_slope;
  // Gradient arrays of layer i: 2 i and 2 i + 1; layers in the order of the parameters.
  const auto parameters_of = [&](auto& layer, int index, const Tensor& input,
                                 const Tensor& d_output) {
    layer.backward_parameters(input, d_output, d_arrays[2 * index], d_arrays[2 * index + 1]);
  };
  // gradient.z holds d_z; the direct way to H is kept there once the scores have theirs.
  Tensor& d_direct = gradient.z;
  select_backward(candidates, state.input, shape_.tile, state.output, gradient.z, gradient.output,
                  d_direct);
  const int last = static_cast<int>(state.hidden.size()) - 1;
  parameters_of(bottleneck_and_head_[1], last + 1, state.hidden[last], gradient.output);
  bottleneck_and_head_[1].backward_input(gradient.output, {}, gradient.hidden[last]);
  for (int level = 0; level < levels() - 1; ++level) {
    const int from = decoder(level);
    ConvTranspose2d& layer = decoders_[levels() - 2 - level];
    leaky_relu_backward(slope, state.hidden[from], gradient.hidden[from]);
    parameters_of(layer, from, state.hidden[from - 1], gradient.hidden[from]);
    layer.backward_input(gradient.hidden[from], {}, gradient.hidden[from - 1]);
  }
  const int bottom = levels();
  leaky_relu_backward(slope, state.hidden[bottom], gradient.hidden[bottom]);
  parameters_of(bottleneck_and_head_[0], bottom, state.hidden[bottom - 1], gradient.hidden[bottom]);
  bottleneck_and_head_[0].backward_input(gradient.hidden[bottom], {}, gradient.hidden[bottom - 1]);
  for (int level = levels() - 1; level > 0; --level) {
    leaky_relu_backward(slope, state.hidden[level], gradient.hidden[level]);
    parameters_of(encoders_[level], level, state.hidden[level - 1], gradient.hidden[level]);
    // The level above also reached the decoder, through the skip.
    encoders_[level].backward_input(gradient.hidden[level],
                                    {&gradient.hidden[decoder(level - 1)]},
                                    gradient.hidden[level - 1]);
  }
  leaky_relu_backward(slope, state.hidden[0], gradient.hidden[0]);
  parameters_of(encoders_[0], 0, state.input, gradient.hidden[0]);
  encoders_[0].backward_input(gradient.hidden[0], {}, gradient.input);
  for (int channel = 0; channel < shape_.tile.pixels(); ++channel) {
    for (int y = 0; y < gradient.input.rows(); ++y) {
      float* to = gradient.input.row(channel, y);
      const float* from = d_direct.row(channel, y);
      for (int x = 0; x < gradient.input.columns(); ++x) to[x] += from[x];
    }
  }
}

}  // namespace

void validate(const UShapedDenoiserShape& shape) {
  constexpr int kMostChannels = 512;
  constexpr int kLargestTile = 16;
  if (shape.channels.size() < 2 || shape.channels.size() > 5) {
    throw Error(
        fmt::format("denoiser: channels of {} levels, expected 2 to 5", shape.channels.size()));
  }
  for (const int channels : shape.channels) check_field("channels", channels, 1, kMostChannels);
  check_field("tile.rows", shape.tile.rows, 1, kLargestTile);
  check_field("tile.columns", shape.tile.columns, 1, kLargestTile);
  check_field("memory", shape.memory, 0, kMostChannels);
  if (!(shape.negative_slope >= 0.0F && shape.negative_slope <= 1.0F)) {
    throw Error(
        fmt::format("denoiser: negative_slope is {}, expected 0 to 1", shape.negative_slope));
  }
}

std::unique_ptr<Denoiser> make_u_shaped_denoiser(const UShapedDenoiserShape& shape, int rows,
                                                 int columns, InstructionSet instruction_set,
                                                 int threads) {
  return std::make_unique<UShapedDenoiser>(shape, rows, columns, instruction_set, threads);
}

}  // namespace hqslam::nn
