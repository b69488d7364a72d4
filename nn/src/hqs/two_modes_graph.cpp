#include "two_modes_graph.h"

#include <fmt/format.h>

#include "../kernels/two_modes.h"

namespace hqslam::nn {
namespace {

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

LayerGraph two_modes_graph(const TwoModesShape& shape, int layer, int rows, int columns,
                           const Engine& engine) {
  const TwoModesLayerShape& of_layer = shape.layers[layer];
  const float slope = shape.negative_slope;
  LayerGraph graph({input_channels(shape, layer), rows, columns}, engine);
  ConvolutionOptions first = three_by_three(of_layer.channels, slope);
  first.row_bias = true;
  const int encoded = graph.add("encoder.0", first, {0});
  int x = graph.add("encoder.1", three_by_three(of_layer.lower_channels, slope, 2), {encoded});
  const ConvolutionOptions lower = three_by_three(of_layer.lower_channels, slope);
  x = graph.add("bottleneck.0", lower, {x});
  for (int block = 1; block <= of_layer.residual_blocks; ++block) {
    x = graph.add(fmt::format("bottleneck.{}", block), lower, {x, x});
  }
  x = graph.add("decoder.0",
                {.channels = of_layer.channels,
                 .kernel = {2, 2},
                 .stride = {2, 2},
                 .transposed = true,
                 .negative_slope = slope},
                {x, encoded});
  graph.add("head", {.channels = two_modes_outputs(shape, layer), .start_scale = 0.1F}, {x});
  return graph;
}

}  // namespace hqslam::nn
