#include "u_shaped_denoiser.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>

#include "../graph/layer_graph.h"
#include "../graph/tensor_sums.h"
#include "../parameters.h"
#include "channels.h"
#include "hqslam/core/error.h"

namespace hqslam::nn {
namespace {

int score_channels(const UShapedDenoiserShape& shape) {
  return kSelectionGroups * shape.tile.pixels();
}

LayerGraph u_shaped_graph(const UShapedDenoiserShape& shape, int rows, int columns,
                          const Engine& engine) {
  const float slope = shape.negative_slope;
  const auto levels = static_cast<int>(shape.channels.size());
  LayerGraph graph(
      {shape.tile.pixels() + shape.memory, rows / shape.tile.rows, columns / shape.tile.columns},
      engine);
  int x = 0;
  std::vector<int> encoded;
  for (int level = 0; level < levels; ++level) {
    x = graph.add(fmt::format("encoder.{}", level),
                  three_by_three(shape.channels[level], slope, level == 0 ? 1 : 2), {x});
    encoded.push_back(x);
  }
  x = graph.add("bottleneck", three_by_three(shape.channels.back(), slope), {x});
  for (int level = levels - 2; level >= 0; --level) {
    x = graph.add(fmt::format("decoder.{}", level),
                  {.channels = shape.channels[level],
                   .kernel = {2, 2},
                   .stride = {2, 2},
                   .transposed = true,
                   .negative_slope = slope},
                  {x, encoded[level]});
  }
  graph.add("head", {.channels = score_channels(shape) + shape.memory, .start_scale = 0.1F}, {x});
  return graph;
}

class UShapedDenoiser final : public Denoiser {
 public:
  UShapedDenoiser(const UShapedDenoiserShape& shape, int rows, int columns,
                  InstructionSet instruction_set, int threads)
      : shape_(shape),
        instruction_set_(instruction_set),
        graph_(u_shaped_graph(shape, rows, columns, {instruction_set, threads})) {
    const Tensor output = graph_.make_values().back();
    head_rows_.assign(threads, std::vector<float>(static_cast<std::size_t>(output.channels()) *
                                                  output.padded_columns()));
  }

  TileSize tile() const override { return shape_.tile; }
  ColumnPadding padding() const override { return ColumnPadding::kCircular; }
  int memory_channels() const override { return shape_.memory; }
  std::vector<ParameterShape> parameter_shapes() const override {
    return graph_.parameter_shapes();
  }
  std::vector<float> initial_parameters(std::uint64_t seed) const override;
  std::int64_t multiply_adds() const override { return graph_.multiply_adds(); }
  DenoiserState make_state(bool for_backward) const override;
  DenoiserState make_gradient() const override;
  void set_parameters(std::span<const float> parameters) override {
    graph_.set_parameters(parameters);
  }
  void forward(const Candidates& candidates, DenoiserState& state,
               std::optional<std::uint64_t> dropout_seed) override;
  void backward(const Candidates& candidates, const DenoiserState& state, DenoiserState& gradient,
                std::span<float> d_parameters) override;
  std::vector<NetworkStep> steps(const Candidates& candidates, DenoiserState& state) override;

 private:
  /// Head and selection one row after the other: a row of scores never leaves the cache. Leaves the
  /// weights, too, where the state has room for them.
  void select_by_row(const Candidates& candidates, DenoiserState& state);

  UShapedDenoiserShape shape_;
  InstructionSet instruction_set_;
  LayerGraph graph_;
  std::vector<std::vector<float>> head_rows_;  ///< a row of the head's result, one per thread
};

std::vector<float> UShapedDenoiser::initial_parameters(std::uint64_t seed) const {
  std::vector<float> parameters = graph_.initial_parameters(seed);
  // The head's biases, which are the last: "here" is the first choice, "nothing" the last.
  constexpr float kFirstScores[kSelectionGroups] = {0.0F, 0.0F, 0.5F, -0.25F, 0.0F};
  const int scores = score_channels(shape_);
  float* biases = parameters.data() + parameters.size() - (scores + shape_.memory);
  for (int i = 0; i < scores; ++i) biases[i] = kFirstScores[i / shape_.tile.pixels()];
  std::fill_n(biases + scores, shape_.memory, 0.0F);
  return parameters;
}

DenoiserState UShapedDenoiser::make_state(bool for_backward) const {
  DenoiserState state{graph_.make_values(), {}};
  const Tensor& of_tiles = state.input();
  const auto tiles = [&](int channels) {
    return Tensor(channels, of_tiles.rows(), of_tiles.columns(), padding());
  };
  state.z = tiles(shape_.tile.pixels());
  if (!for_backward) state.output() = tiles(std::max(1, shape_.memory));
  return state;
}

DenoiserState UShapedDenoiser::make_gradient() const {
  DenoiserState gradient = make_state(false);
  // Two rows in one go cost fewer sums of lanes, more would leave the second-level cache.
  const int rows = gradient.z.rows() % 2 == 0 ? 2 : 1;
  gradient.part =
      Tensor(score_channels(shape_) + shape_.memory, rows, gradient.z.columns(), padding(), 0);
  return gradient;
}

void UShapedDenoiser::forward(const Candidates& candidates, DenoiserState& state,
                              std::optional<std::uint64_t> /*dropout_seed*/) {
  graph_.forward(state.values, {.left_out = 1});
  select_by_row(candidates, state);
}

void UShapedDenoiser::select_by_row(const Candidates& candidates, DenoiserState& state) {
  Tensor& output = state.output();
  const bool kept = output.channels() == score_channels(shape_) + shape_.memory;
  const std::int64_t stride = kept ? output.channel_stride() : output.padded_columns();
#pragma omp for schedule(static)
  for (int row = 0; row < state.z.rows(); ++row) {
    float* scores_of_row = kept ? output.row(0, row) : head_rows_[omp_get_thread_num()].data();
    graph_.last_row(state.values, row, scores_of_row, stride);
    select_row(candidates, state.input(), shape_.tile, instruction_set_, row, scores_of_row, stride,
               state.z);
    if (kept) continue;
    for (int channel = 0; channel < shape_.memory; ++channel) {
      std::copy_n(scores_of_row + (score_channels(shape_) + channel) * stride, output.columns(),
                  output.row(channel, row));
    }
  }
}

std::vector<NetworkStep> UShapedDenoiser::steps(const Candidates& candidates,
                                                DenoiserState& state) {
  std::vector<NetworkStep> steps = graph_.steps(state.values);
  steps.back().name = "head, selection";
  steps.back().run = [this, &candidates, &state] { select_by_row(candidates, state); };
  return steps;
}

void UShapedDenoiser::backward(const Candidates& candidates, const DenoiserState& state,
                               DenoiserState& gradient, std::span<float> d_parameters) {
  // gradient.z holds d_z; the direct way to H is kept there once the scores have theirs.
  Tensor& d_direct = gradient.z;
  Tensor& d_output = gradient.part;
  const int scores = score_channels(shape_);
  for (int first = 0; first < gradient.z.rows(); first += d_output.rows()) {
    select_backward(candidates, state.input(), shape_.tile, instruction_set_, first, state.output(),
                    gradient.z, d_output, d_direct);
    for (int y = 0; y < d_output.rows(); ++y) {
      for (int channel = 0; channel < shape_.memory; ++channel) {
        std::copy_n(gradient.output().row(channel, first + y), d_output.columns(),
                    d_output.row(scores + channel, y));
      }
    }
    graph_.last_backward_rows(state.values, first, d_output, gradient.values, d_parameters);
  }
  graph_.backward({&state.values, 1}, {&gradient.values, 1}, d_parameters, {.left_out = 1});
  add_channels(d_direct, 0, gradient.input(), shape_.tile.pixels());
}

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
  check_slope(shape.negative_slope);
}

}  // namespace

DenoiserDescription u_shaped_denoiser(const UShapedDenoiserShape& shape) {
  validate(shape);
  const int halvings = 1 << (shape.channels.size() - 1);
  return {"u-shaped",
          {{"tile_rows", shape.tile.rows},
           {"tile_columns", shape.tile.columns},
           {"channels", shape.channels},
           {"memory", shape.memory},
           {"negative_slope", shape.negative_slope}},
          {shape.tile.rows * halvings, shape.tile.columns * halvings},
          [shape](int rows, int columns, InstructionSet instruction_set, int threads) {
            return std::make_unique<UShapedDenoiser>(shape, rows, columns, instruction_set,
                                                     threads);
          }};
}

DenoiserDescription read_u_shaped_denoiser(JsonFields& sizes) {
  UShapedDenoiserShape shape;
  sizes.optional("tile_rows", shape.tile.rows);
  sizes.optional("tile_columns", shape.tile.columns);
  if (sizes.has("channels")) shape.channels = sizes.integers("channels");
  sizes.optional("memory", shape.memory);
  sizes.optional("negative_slope", shape.negative_slope);
  return u_shaped_denoiser(shape);
}

}  // namespace hqslam::nn
