#include "two_modes_graph.h"

#include <fmt/format.h>

#include "../kernels/two_modes.h"

namespace hqslam::nn {
namespace {

// The tensors of a layer's graph, in their order.
enum GraphTensor { kInput, kEncoded, kLower, kBottleneck };

int computed_pixels(const TwoModesShape& shape) { return shape.tile.pixels() - shape.tile.columns; }

/// H, validity of what was measured, ln above - ln below; later layers also see the probability of
/// a return and the memory of the layer before.
int input_channels(const TwoModesShape& shape, int layer) {
  const int first = shape.tile.pixels() + 2 * shape.tile.columns;
  return layer == 0 ? first : first + computed_pixels(shape) + shape.memory;
}

}  // namespace

bool is_last_layer(const TwoModesShape& shape, int layer) {
  return layer + 1 == static_cast<int>(shape.layers.size());
}

int two_modes_outputs(const TwoModesShape& shape, int layer) {
  return kTwoModesOutputs * computed_pixels(shape) +
         (is_last_layer(shape, layer) ? 0 : shape.memory);
}

ConvolutionGraph two_modes_graph(const TwoModesShape& shape, int layer, int rows, int columns,
                                 InstructionSet instruction_set, int threads) {
  const TwoModesLayerShape& of_layer = shape.layers[layer];
  const float slope = shape.negative_slope;
  std::vector<int> channels{input_channels(shape, layer), of_layer.channels,
                            of_layer.lower_channels, of_layer.lower_channels};
  std::vector<ConvolutionStep> steps;
  steps.push_back({.name = "encoder.0",
                   .from = kInput,
                   .to = kEncoded,
                   .negative_slope = slope,
                   .row_bias = true});
  steps.push_back(
      {.name = "encoder.1", .stride = 2, .from = kEncoded, .to = kLower, .negative_slope = slope});
  steps.push_back(
      {.name = "bottleneck.0", .from = kLower, .to = kBottleneck, .negative_slope = slope});
  int from = kBottleneck;
  for (int block = 1; block <= of_layer.residual_blocks; ++block) {
    steps.push_back({.name = fmt::format("bottleneck.{}", block),
                     .from = from,
                     .to = from + 1,
                     .skip = from,
                     .negative_slope = slope});
    channels.push_back(of_layer.lower_channels);
    ++from;
  }
  steps.push_back({.name = "decoder.0",
                   .transposed = true,
                   .kernel = 2,
                   .stride = 2,
                   .from = from,
                   .to = from + 1,
                   .skip = kEncoded,
                   .negative_slope = slope});
  channels.push_back(of_layer.channels);
  steps.push_back(
      {.name = "head", .kernel = 1, .from = from + 1, .to = from + 2, .start_scale = 0.1F});
  channels.push_back(two_modes_outputs(shape, layer));
  return {std::move(steps), channels, rows, columns, instruction_set, threads};
}

}  // namespace hqslam::nn
