#include "two_modes_prior.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "hqslam/core/error.h"
#include "kernels/row_kernels.h"
#include "kernels/two_modes.h"
#include "parameters.h"

namespace hqslam::nn {
namespace {

/// Rows for which a tile's input has what is recalled, with a network for any table of beams.
constexpr int kRecalledRows = 4;

int computed_pixels_of(TileSize tile) { return tile.pixels() - tile.columns; }

/// The tile's pixel rows of what is recalled in the input, from the top; nothing: none is there.
/// For any table of beams they are 3/4, 1/2 and 1/4 of the gap above the measured row, and that
/// row.
std::vector<std::optional<int>> recalled_rows(const TwoModesShape& shape) {
  const int rows = shape.tile.rows;
  std::vector<std::optional<int>> result(shape.any_beams ? kRecalledRows : rows);
  for (int row = 0; row < rows; ++row) {
    const int above = rows - 1 - row;  // the measured row, which is the last one
    const int place = (2 * kRecalledRows * above + rows) / (2 * rows);  // rounded
    result[shape.any_beams ? kRecalledRows - 1 - place : row] = row;
  }
  return result;
}

/// rows x columns: of the tiles.
LayerGraph two_modes_graph(const TwoModesShape& shape, int rows, int columns,
                           const Engine& engine) {
  const float slope = shape.negative_slope;
  const auto recalled = shape.scan_memory
                            ? 2 * static_cast<int>(recalled_rows(shape).size()) * shape.tile.columns
                            : 0;
  const int ranges = shape.any_beams ? shape.tile.columns : shape.tile.pixels();
  LayerGraph graph({ranges + 2 * shape.tile.columns + recalled, rows, columns}, engine);
  ConvolutionOptions first = three_by_three(shape.channels, slope);
  first.row_bias = true;
  const int encoded = graph.add("encoder.0", first, {0});
  int x = graph.add("encoder.1", three_by_three(shape.lower_channels, slope, 2), {encoded});
  const ConvolutionOptions lower = three_by_three(shape.lower_channels, slope);
  x = graph.add("bottleneck.0", lower, {x});
  for (int block = 1; block <= shape.residual_blocks; ++block) {
    x = graph.add(fmt::format("bottleneck.{}", block), lower, {x, x});
  }
  x = graph.add("decoder.0",
                {.channels = shape.channels,
                 .kernel = {2, 2},
                 .stride = {2, 2},
                 .transposed = true,
                 .negative_slope = slope},
                {x, encoded});
  const int outputs = two_modes_outputs(shape.scan_memory) * computed_pixels_of(shape.tile);
  graph.add("head", {.channels = outputs, .row_weights = shape.any_beams, .start_scale = 0.1F},
            {x});
  return graph;
}

void validate(const TwoModesShape& shape) {
  constexpr int kMostChannels = 512;
  constexpr int kLargestTile = 16;
  constexpr int kMostBlocks = 32;
  check_field("tile.columns", shape.tile.columns, 1, kLargestTile);
  const bool recalls_any = shape.scan_memory && shape.any_beams;
  check_field("tile.rows", shape.tile.rows, 2, recalls_any ? kRecalledRows : kLargestTile);
  check_field("memory", shape.memory, 0, kMostChannels);
  check_field("channels", shape.channels, 1, kMostChannels);
  check_field("lower_channels", shape.lower_channels, 1, kMostChannels);
  check_field("residual_blocks", shape.residual_blocks, 0, kMostBlocks);
  check_slope(shape.negative_slope);
}

void check_rows(const TwoModesShape& shape, const NetworkDescription& d) {
  const TileSize tile = shape.tile;
  if (shape.scan_memory && shape.any_beams && d.measured_rows.offset != tile.rows - 1) {
    throw Error(
        "denoiser: measured rows {} + n {}, expected the last of every {} for a network with a "
        "memory for any table of beams",
        d.measured_rows.offset, d.measured_rows.stride, tile.rows);
  }
  if (tile.rows != d.measured_rows.stride || d.measured_rows.offset >= tile.rows ||
      d.sensor.rows() % (2 * tile.rows) != 0) {
    throw Error(
        "denoiser: tiles of {} rows and measured rows {} + n {} of {}, expected one measured row "
        "in each tile and an even number of tiles",
        tile.rows, d.measured_rows.offset, d.measured_rows.stride, d.sensor.rows());
  }
}

}  // namespace

TwoModesPrior::TwoModesPrior(const TwoModesShape& shape, LayerGraph graph,
                             const NetworkDescription& d, int columns, const Engine& engine)
    : Prior(std::move(graph), shape.tile),
      description_(d),
      kernels_(kernels::row_kernels(engine.instruction_set)),
      ranges_(d, shape.tile, columns, shape.scan_memory, engine),
      pixels_(computed_pixels_of(shape.tile)),
      outputs_(two_modes_outputs(shape.scan_memory)) {
  if (shape.scan_memory) recalled_rows_ = recalled_rows(shape);
  if (shape.any_beams) {
    beams_.emplace(d.sensor, d.measured_rows, shape.tile, graph_.parameter_shapes());
  }
  stride_ = tiles(1).padded_columns();
  // A row of the head's result, then ranges and confidences of a row of tiles.
  const std::size_t channels = (outputs_ + 2) * ranges_.computed().size();
  scratch_.assign(engine.threads, std::vector<float>(channels * static_cast<std::size_t>(stride_)));
}

PriorState TwoModesPrior::make_state(bool for_backward) const {
  PriorState state = Prior::make_state(for_backward);
  state.own_h = state.probability = state.z;
  if (!for_backward) state.output() = tiles(1);
  return state;
}

/// The input of the convolutions.
void TwoModesPrior::take_row(int row, const PriorState* /*before*/, PriorState& state) {
  Tensor& input = state.input();
  const auto put = [&](int channel, auto value) {
    float* to = input.row(channel, row);
#pragma omp simd
    for (int x = 0; x < input.columns(); ++x) to[x] = value(x);
    input.fill_border(channel, row);
  };
  int channel = 0;
  const int ranges = beams() != nullptr ? tile().columns : tile().pixels();
  for (; channel < ranges; ++channel) {
    const float* h =
        beams() != nullptr ? ranges_.log_row(channel, row) : state.own_h.row(channel, row);
    put(channel, [&](int x) { return 0.5F * (h[x] - LogRanges::kTypicalLogRange); });
  }
  for (int phase = 0; phase < tile().columns; ++phase) {
    const float* valid = ranges_.valid_row(phase, row);
    put(channel++, [&](int x) { return valid[x] - 0.5F; });
  }
  for (int phase = 0; phase < tile().columns; ++phase) {
    const float* above = ranges_.log_row(phase, std::max(row - 1, 0));
    const float* below = ranges_.log_row(phase, row);
    put(channel++, [&](int x) { return std::clamp(above[x] - below[x], -1.0F, 1.0F); });
  }
  for (const std::optional<int> row_in_tile : recalled_rows_) {
    for (int phase = 0; phase < tile().columns; ++phase) {
      const int pixel = row_in_tile.value_or(0) * tile().columns + phase;
      const float* step = row_in_tile ? ranges_.recalled_step_row(pixel, row) : nullptr;
      const float* share = row_in_tile ? ranges_.recalled_share_row(pixel, row) : nullptr;
      put(channel++, [&](int x) { return step ? std::clamp(step[x], -1.0F, 1.0F) : 0.0F; });
      put(channel++, [&](int x) { return share ? share[x] - 0.5F : -0.5F; });
    }
  }
}

void TwoModesPrior::forward(const Candidates& /*candidates*/, PriorState& state,
                            const PriorPass& pass) {
  graph_.forward(state.values, {.left_out = 1});
  compute_modes(state, pass);
}

kernels::TwoModesInput TwoModesPrior::modes_input(const PriorState& state, int pixel, int row,
                                                  const float* outputs,
                                                  std::int64_t channel_stride) const {
  const ComputedPixel& computed = ranges_.computed()[pixel];
  return {.outputs = outputs + pixel * channel_stride,
          .group_stride = pixels_ * channel_stride,
          .above = ranges_.above(computed, row),
          .below = ranges_.below(computed, row),
          .middle = state.own_h.row(computed.channel, row),
          .recalled_step = ranges_.recalled_step_row(computed.channel, row),
          .recalled_share = ranges_.recalled_share_row(computed.channel, row),
          .columns = ranges_.columns()};
}

/// The head and the modes of each pixel, one row after the other: a row of outputs never leaves the
/// cache.
void TwoModesPrior::compute_modes(PriorState& state, const PriorPass& pass) {
  const bool kept = state.output().channels() > 1;
  const std::int64_t stride = kept ? state.output().channel_stride() : stride_;
#pragma omp for schedule(static)
  for (int row = 0; row < ranges_.rows(); ++row) {
    float* own = scratch_[omp_get_thread_num()].data();
    float* of_head = kept ? state.output().row(0, row) : own;
    float* ranges = own + outputs_ * pixels_ * stride_;
    float* confidences = ranges + pixels_ * stride_;
    graph_.last_row(state.values, row, of_head, stride);
    for (int pixel = 0; pixel < pixels_; ++pixel) {
      const int channel = ranges_.computed()[pixel].channel;
      kernels_.two_modes({.in = modes_input(state, pixel, row, of_head, stride),
                          .tolerance_m = pass.tolerance_m,
                          .confidence_exponent = description_.confidence_exponent,
                          .log_range = state.z.row(channel, row),
                          .probability = state.probability.row(channel, row),
                          .range_m = pass.upsampled ? ranges + pixel * stride_ : nullptr,
                          .confidence = pass.upsampled ? confidences + pixel * stride_ : nullptr});
    }
    if (pass.upsampled != nullptr) finish_image_row(row, ranges, confidences, *pass.upsampled);
  }
}

/// One row of tiles of the result: measured pixels as they were, computed ones within the sensor's
/// limits.
void TwoModesPrior::finish_image_row(int row, const float* ranges, const float* confidences,
                                     UpsampledImage& upsampled) const {
  RangeImage& image = upsampled.image;
  const auto nearest_m = static_cast<float>(description_.sensor.min_range_m);
  const auto farthest_m = static_cast<float>(description_.sensor.max_range_m);
  const int step = tile().columns;
  for (int pixel = 0; pixel < pixels_; ++pixel) {
    const int channel = ranges_.computed()[pixel].channel;
    const std::size_t first = image.index(row * tile().rows + channel / step, channel % step);
    float* range_m = &image.range_m[first];
    float* confidence = &upsampled.confidence[first];
    const float* range = ranges + pixel * stride_;
    const float* sure = confidences + pixel * stride_;
    for (int x = 0; x < ranges_.columns(); ++x) {
      const bool there = range[x] >= nearest_m && range[x] <= farthest_m;
      range_m[x * step] = there ? range[x] : 0.0F;
      confidence[x * step] = there ? sure[x] : 0.0F;
    }
  }
  const std::size_t first = image.index(row * tile().rows + description_.measured_rows.offset, 0);
  for (int column = 0; column < image.columns; ++column) {
    const bool valid = ranges_.valid_row(column % step, row)[column / step] > 0.0F;
    image.range_m[first + column] = valid ? ranges_.measured_m().at(row, column) : 0.0F;
    upsampled.confidence[first + column] = valid ? 1.0F : 0.0F;
  }
}

void TwoModesPrior::add_inner(const Measurement& measurement, const PriorState& state,
                              const std::string& prefix, Trace& trace) const {
  Prior::add_inner(measurement, state, prefix, trace);
  Tensor mode1 = tiles(tile().pixels());
  Tensor mode2 = mode1;
  Tensor weight1 = mode1;
  Tensor scale = mode1;
  Tensor z = state.z;
  Tensor probability = state.probability;
  const Tensor& output = state.output();
  for (int row = 0; row < ranges_.rows(); ++row) {
    for (int pixel = 0; pixel < pixels_; ++pixel) {
      const int channel = ranges_.computed()[pixel].channel;
      kernels_.two_modes(
          {.in = modes_input(state, pixel, row, output.row(0, row), output.channel_stride()),
           .log_range = z.row(channel, row),
           .probability = probability.row(channel, row),
           .mode_1 = mode1.row(channel, row),
           .mode_2 = mode2.row(channel, row),
           .weight_1 = weight1.row(channel, row),
           .scale = scale.row(channel, row)});
    }
    for (int phase = 0; phase < tile().columns; ++phase) {
      const int channel = description_.measured_rows.offset * tile().columns + phase;
      std::copy_n(ranges_.valid_row(phase, row), ranges_.columns(), probability.row(channel, row));
    }
  }
  trace.add(traced_image("mode_1", ranges_.in_metres(mode1)));
  trace.add(traced_image("mode_2", ranges_.in_metres(mode2)));
  trace.add(traced_pixels("weight_1", weight1, 0, tile()));
  trace.add(traced_pixels("scale", scale, 0, tile()));
  trace.add(traced_pixels("probability", probability, 0, tile()));
}

PriorDescription two_modes_prior(const TwoModesShape& shape) {
  validate(shape);
  nlohmann::ordered_json layer = {{"channels", shape.channels},
                                  {"lower_channels", shape.lower_channels},
                                  {"residual_blocks", shape.residual_blocks}};
  nlohmann::ordered_json sizes = {{"tile_rows", shape.tile.rows},
                                  {"tile_columns", shape.tile.columns},
                                  {"memory", shape.memory},
                                  {"negative_slope", shape.negative_slope},
                                  {"layers", nlohmann::ordered_json::array({std::move(layer)})}};
  if (shape.scan_memory) sizes["scan_memory"] = true;
  if (shape.any_beams) sizes["any_beams"] = true;
  PriorDescription prior{.sizes = std::move(sizes),
                         .multiple = {2 * shape.tile.rows, 2 * shape.tile.columns},
                         .scan_memory = shape.scan_memory,
                         .any_beams = shape.any_beams ? shape.tile : TileSize{},
                         .graph =
                             [shape](int rows, int columns, const Engine& engine) {
                               return two_modes_graph(shape, rows / shape.tile.rows,
                                                      columns / shape.tile.columns, engine);
                             },
                         .make =
                             [shape](LayerGraph graph, const NetworkDescription& d, int columns,
                                     const Engine& engine) {
                               return std::make_unique<TwoModesPrior>(shape, std::move(graph), d,
                                                                      columns, engine);
                             },
                         .check = [shape](const NetworkDescription& d) { check_rows(shape, d); }};
  if (shape.any_beams) {
    prior.with_tile_rows = [shape](int tile_rows) {
      TwoModesShape other = shape;
      other.tile.rows = tile_rows;
      return two_modes_prior(other);
    };
  }
  return prior;
}

PriorDescription read_two_modes_prior(JsonFields& sizes) {
  TwoModesShape shape;
  sizes.optional("tile_rows", shape.tile.rows);
  sizes.optional("tile_columns", shape.tile.columns);
  sizes.optional("memory", shape.memory);
  sizes.optional("scan_memory", shape.scan_memory);
  sizes.optional("any_beams", shape.any_beams);
  sizes.optional("negative_slope", shape.negative_slope);
  if (sizes.has("layers")) {
    std::vector<JsonFields> layers = sizes.objects("layers");
    check_field("layers", static_cast<int>(layers.size()), 1, 1);
    layers.front().optional("channels", shape.channels);
    layers.front().optional("lower_channels", shape.lower_channels);
    layers.front().optional("residual_blocks", shape.residual_blocks);
    layers.front().finish();
  }
  return two_modes_prior(shape);
}

}  // namespace hqslam::nn
