#include "u_shaped_prior.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>

#include "hqslam/core/error.h"
#include "hqslam/nn/interpolation.h"
#include "kernels/row_kernels.h"
#include "parameters.h"

namespace hqslam::nn {
namespace {

LayerGraph u_shaped_graph(const UShapedPriorShape& shape, int rows, int columns,
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
  graph.add("head", {.channels = shape.scores() + shape.memory, .start_scale = 0.1F}, {x});
  return graph;
}

void validate(const UShapedPriorShape& shape) {
  constexpr int kMostChannels = 512;
  constexpr int kLargestTile = 16;
  if (shape.channels.size() < 2 || shape.channels.size() > 5) {
    throw Error("denoiser: channels of {} levels, expected 2 to 5", shape.channels.size());
  }
  for (const int channels : shape.channels) check_field("channels", channels, 1, kMostChannels);
  check_field("tile.rows", shape.tile.rows, 1, kLargestTile);
  check_field("tile.columns", shape.tile.columns, 1, kLargestTile);
  check_field("memory", shape.memory, 0, kMostChannels);
  check_slope(shape.negative_slope);
}

/// The head's biases, which are the last: "here" is the first choice, "nothing" the last.
void set_first_scores(const UShapedPriorShape& shape, std::span<float> parameters) {
  constexpr float kFirstScores[kSelectionGroups] = {0.0F, 0.0F, 0.5F, -0.25F, 0.0F};
  const std::span<float> biases = parameters.last(shape.scores() + shape.memory);
  std::ranges::fill(biases, 0.0F);
  for (int i = 0; i < shape.scores(); ++i) biases[i] = kFirstScores[i / shape.tile.pixels()];
}

}  // namespace

UShapedPrior::UShapedPrior(const UShapedPriorShape& shape, LayerGraph graph,
                           const NetworkDescription& network, const Engine& engine)
    : Prior(std::move(graph), shape.tile), shape_(shape) {
  const int rows = network.sensor.rows();
  const RowSelection measured = network.measured_rows;
  for (int row = 0; row < rows && shape.neighbours_of_h; ++row) {
    const RowsBetween between = rows_between(row, measured, measured_row_count(rows, measured));
    above_.push_back(measured.offset + between.above * measured.stride);
    below_.push_back(measured.offset + between.below * measured.stride);
  }
  const Tensor output = graph_.output_shape().make();
  head_rows_.assign(engine.threads, std::vector<float>(static_cast<std::size_t>(output.channels()) *
                                                       output.padded_columns()));
}

PriorState UShapedPrior::make_state(bool for_backward) const {
  PriorState state = Prior::make_state(for_backward);
  if (!for_backward) {
    state.output() =
        Tensor(std::max(1, shape_.memory), state.z.rows(), state.z.columns(), padding());
  }
  return state;
}

/// The memory of the layer before; the first has none.
void UShapedPrior::take_row(int row, const PriorState* before, PriorState& state) {
  const int pixels = tile().pixels();
  if (before == nullptr) {
    clear_channels_row(pixels, row, state.input());
  } else if (shape_.memory > 0) {
    const int first = before->output().channels() - shape_.memory;
    copy_channels_row(before->output(), first, shape_.memory, row, state.input(), pixels);
  }
}

void UShapedPrior::forward(const Candidates& candidates, PriorState& state,
                           const PriorPass& /*pass*/) {
  graph_.forward(state.values, {.left_out = 1});
  select_by_row(candidates, state);
}

CandidatesOf UShapedPrior::candidates_of(const Candidates& measured, const Tensor& h) const {
  if (!shape_.neighbours_of_h) {
    return [&measured](int channel, int row) {
      return CandidateRows{measured.above.row(channel, row), measured.below.row(channel, row)};
    };
  }
  return [this, &h](int channel, int row) {
    return CandidateRows{above(channel, row, h), below(channel, row, h)};
  };
}

void UShapedPrior::select_by_row(const Candidates& candidates, PriorState& state) {
  const CandidatesOf candidates_here = candidates_of(candidates, state.input());
  Tensor& output = state.output();
  const bool kept = output.channels() == shape_.scores() + shape_.memory;
  const std::int64_t stride = kept ? output.channel_stride() : output.padded_columns();
#pragma omp for schedule(static)
  for (int row = 0; row < state.z.rows(); ++row) {
    float* scores_of_row = kept ? output.row(0, row) : head_rows_[omp_get_thread_num()].data();
    graph_.last_row(state.values, row, scores_of_row, stride);
    select_row(candidates_here, state.input(), shape_.tile, graph_.engine().instruction_set, row,
               scores_of_row, stride, state.z);
    if (kept) continue;
    for (int channel = 0; channel < shape_.memory; ++channel) {
      std::copy_n(scores_of_row + (shape_.scores() + channel) * stride, output.columns(),
                  output.row(channel, row));
    }
  }
}

/// What the choice weighs, and what is added to it.
void UShapedPrior::add_inner(const Measurement& measurement, const PriorState& state,
                             const std::string& prefix, Trace& trace) const {
  Prior::add_inner(measurement, state, prefix, trace);
  const int pixels = tile().pixels();
  int group = 0;
  for (const char* what : {"choice.above", "choice.below", "choice.here", "choice.nothing"}) {
    trace.add(traced_pixels(prefix + what, state.output(), pixels * group++, tile()));
  }
  Tensor correction = state.z;
  for (int row = 0; row < correction.rows(); ++row) {
    copy_channels_row(state.output(), pixels * group, pixels, row, correction, 0);
  }
  trace.add(traced_image(prefix + "choice.correction", measurement.in_metres(correction)));
  if (shape_.memory > 0) {
    trace.add(traced(prefix + "memory", state.output(), shape_.scores(), shape_.memory));
  }
}

PriorDescription u_shaped_prior(const UShapedPriorShape& shape) {
  validate(shape);
  const int halvings = 1 << (shape.channels.size() - 1);
  return {
      .sizes = {{"tile_rows", shape.tile.rows},
                {"tile_columns", shape.tile.columns},
                {"channels", shape.channels},
                {"memory", shape.memory},
                {"negative_slope", shape.negative_slope},
                {"neighbours", shape.neighbours_of_h ? "h" : "l"}},
      .multiple = {shape.tile.rows * halvings, shape.tile.columns * halvings},
      .graph = [shape](
                   int rows, int columns,
                   const Engine& engine) { return u_shaped_graph(shape, rows, columns, engine); },
      .make =
          [shape](LayerGraph graph, const NetworkDescription& network, int, const Engine& engine) {
            return std::make_unique<UShapedPrior>(shape, std::move(graph), network, engine);
          },
      .start = [shape](std::span<float> parameters) { set_first_scores(shape, parameters); }};
}

PriorDescription read_u_shaped_prior(JsonFields& sizes) {
  UShapedPriorShape shape;
  sizes.optional("tile_rows", shape.tile.rows);
  sizes.optional("tile_columns", shape.tile.columns);
  if (sizes.has("channels")) shape.channels = sizes.integers("channels");
  sizes.optional("memory", shape.memory);
  sizes.optional("negative_slope", shape.negative_slope);
  shape.neighbours_of_h = sizes.has("neighbours") && sizes.choice("neighbours", {"l", "h"}) == 1;
  return u_shaped_prior(shape);
}

void select_row(const CandidatesOf& candidates, const Tensor& h, TileSize tile,
                InstructionSet instruction_set, int row, float* scores, std::int64_t channel_stride,
                Tensor& z) {
  const kernels::RowKernels& kernels = kernels::row_kernels(instruction_set);
  for (int channel = 0; channel < tile.pixels(); ++channel) {
    const CandidateRows beside = candidates(channel, row);
    kernels.select({.gain = kSelectionGain,
                    .scores = scores + channel * channel_stride,
                    .group_stride = tile.pixels() * channel_stride,
                    .above = beside.above,
                    .below = beside.below,
                    .here = h.row(channel, row),
                    .z = z.row(channel, row),
                    .columns = z.columns()});
  }
}

}  // namespace hqslam::nn
