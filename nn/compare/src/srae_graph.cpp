#include "srae_graph.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "layers/layers.h"

namespace hqslam::nn {
namespace {

constexpr int kLevels = 5;
constexpr float kEpsilon = 1e-3F;  // Keras' batch norm

/// Adds layers to a graph; every function returns the number of its result.
struct Builder {
  LayerGraph graph;
  Purpose purpose;
  Engine engine;

  /// Convolution, batch norm, ReLU.
  int unit(const std::string& name, ConvolutionOptions options, int from) {
    options.kernel_rows = options.kernel_columns = 3;
    options.padding_rows = options.padding_columns = 1;
    const auto taps = static_cast<float>(9 * graph.shape(from).channels);
    options.start_deviation = std::sqrt(2.0F / taps);  // He et al., 2015
    if (purpose == Purpose::kLifting) {
      options.negative_slope = 0.0F;
      return graph.add(
          name, make_normalised_convolution(options, kEpsilon, graph.shape(from), engine), {from});
    }
    const int sums = graph.add(name + ".convolution",
                               make_convolution(options, graph.shape(from), engine), {from});
    return graph.add(name + ".norm", make_batch_norm(kEpsilon, 0.0F, graph.shape(sums)), {sums});
  }

  int up(const std::string& name, int channels, int stride_columns, int from) {
    return unit(name,
                {.channels = channels,
                 .stride_rows = 2,
                 .stride_columns = stride_columns,
                 .transposed = true},
                from);
  }

  int two_units(const std::string& name, int channels, int from) {
    const int first = unit(name + ".0", {.channels = channels}, from);
    return unit(name + ".1", {.channels = channels}, first);
  }

  int dropout(float share, int from) {
    return graph.add("dropout", make_dropout(share, graph.shape(from)), {from});
  }
};

}  // namespace

LayerGraph srae_graph(const SraeShape& shape, const TensorShape& input, int upscaling,
                      Purpose purpose, const Engine& engine) {
  Builder build{LayerGraph(input), purpose, engine};
  LayerGraph& graph = build.graph;
  int x = 0;
  for (int i = 0; 1 << i < upscaling; ++i)
    x = build.up(fmt::format("up.{}", i), shape.filters, 1, x);
  std::array<int, kLevels> sides{};
  for (int level = 0; level < kLevels; ++level) {
    if (level > 0) {
      const int pooled = graph.add("pool", make_average_pool(graph.shape(x)), {x});
      x = build.dropout(shape.dropout, pooled);
    }
    x = build.two_units(fmt::format("encoder.{}", level), shape.filters << level, x);
    sides[level] = x;
  }
  for (int i = 0; i + 1 < kLevels; ++i) {
    const int level = kLevels - 2 - i;
    const std::string name = fmt::format("decoder.{}", i);
    const int dropped = build.dropout(shape.dropout, x);
    const int up = build.up(name + ".up", shape.filters << level, 2, dropped);
    const int both = graph.add(
        "side", make_concatenation(graph.shape(up), graph.shape(sides[level])), {up, sides[level]});
    x = build.two_units(name, shape.filters << level, both);
  }
  // With few filters all weights of the head may be negative at the start; without a bias its ReLU
  // would then be dead for good.
  constexpr float kHeadBias = 0.1F;
  graph.add(
      "head",
      make_convolution({.channels = 1,
                        .negative_slope = 0.0F,
                        .start_deviation = std::sqrt(1.0F / static_cast<float>(shape.filters)),
                        .start_bias = kHeadBias},
                       graph.shape(x), engine),
      {x});
  return std::move(graph);
}

}  // namespace hqslam::nn
