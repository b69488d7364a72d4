#include "srae.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "hqslam/core/error.h"
#include "layers/layers.h"
#include "parameters.h"
#include "srae_network.h"

namespace hqslam::nn {
namespace {

constexpr int kLevels = 5;

/// Adds layers to a graph; every function returns the number of its result.
struct SraeBuilder {
  LayerGraph graph;

  /// Convolution, batch norm, ReLU, dropout.
  int unit(const std::string& name, ConvolutionOptions options, float dropout, int from) {
    const auto taps = static_cast<float>(9 * graph.shape(from).channels);
    // He et al., 2015
    options.start_limit = std::numbers::sqrt3_v<float> * std::sqrt(2.0F / taps);
    const int sums = graph.add(name + ".convolution", options, {from});
    return graph.add(name + ".norm", make_batch_norm(0.0F, graph.shape(sums)), {sums}, dropout);
  }

  int up(const std::string& name, int channels, int stride_columns, int from) {
    ConvolutionOptions options = three_by_three(channels, 1.0F);
    options.stride = {2, stride_columns};
    options.transposed = true;
    return unit(name, options, 0.0F, from);
  }

  int two_units(const std::string& name, int channels, float dropout, int from) {
    const int first = unit(name + ".0", three_by_three(channels, 1.0F), 0.0F, from);
    return unit(name + ".1", three_by_three(channels, 1.0F), dropout, first);
  }
};

}  // namespace

Srae::Srae(const SraeShape& shape) : shape_(shape) {
  constexpr int kMostFilters = 128;
  constexpr int kMostPasses = 1000;
  check_field("filters", shape.filters, 1, kMostFilters);
  check_field("passes", shape.passes, 1, kMostPasses);
  check_that(shape.dropout >= 0.0F && shape.dropout < 1.0F, "network", "dropout", shape.dropout,
             "0 to below 1");
  check_that(shape.largest_deviation >= 0.0F, "network", "largest_deviation",
             shape.largest_deviation, "at least 0");
}

void Srae::write(nlohmann::ordered_json& network) const {
  network["filters"] = shape_.filters;
  network["dropout"] = shape_.dropout;
  network["passes"] = shape_.passes;
  network["largest_deviation"] = shape_.largest_deviation;
}

std::shared_ptr<const Architecture> read_srae(JsonFields& network) {
  SraeShape shape;
  network.optional("filters", shape.filters);
  network.optional("dropout", shape.dropout);
  network.optional("passes", shape.passes);
  network.optional("largest_deviation", shape.largest_deviation);
  return std::make_shared<Srae>(shape);
}

void Srae::validate(const NetworkDescription& d) const {
  const int rows = d.sensor.rows();
  const int stride = d.measured_rows.stride;
  if (!std::has_single_bit(static_cast<unsigned>(stride)) || rows % stride != 0 ||
      d.measured_rows.offset >= stride || rows % kSraeStride != 0) {
    throw Error(
        "network: measured rows {} + n {} of {}, expected one in each 2, 4, 8, ... rows and a "
        "multiple of {} rows in all",
        d.measured_rows.offset, stride, rows, kSraeStride);
  }
  constexpr std::int64_t kTensorsOfFilters = 40;  // with gradients, of the whole image's size
  check_memory(kTensorsOfFilters * shape_.filters * rows * d.sensor.columns, d);
}

std::vector<ParameterShape> Srae::parameter_shapes(const NetworkDescription& d) const {
  return graph(d, kSraeStride, {}).parameter_shapes();
}

std::vector<float> Srae::initial_parameters(const NetworkDescription& d, std::uint64_t seed) const {
  return graph(d, kSraeStride, {}).initial_parameters(seed);
}

std::unique_ptr<Network> Srae::make_network(const NetworkDescription& d, int columns,
                                            InstructionSet instruction_set, int threads) const {
  return std::make_unique<SraeNetwork>(*this, d, columns, Engine{instruction_set, threads});
}

/// With zeros beyond all edges, as in the paper.
LayerGraph Srae::graph(const NetworkDescription& d, int columns, const Engine& engine) const {
  const int upscaling = d.measured_rows.stride;
  const TensorShape input{1, d.sensor.rows() / upscaling, columns, ColumnPadding::kZero};
  SraeBuilder build{LayerGraph(input, engine)};
  LayerGraph& graph = build.graph;
  int x = 0;
  for (int i = 0; 1 << i < upscaling; ++i) {
    x = build.up(fmt::format("up.{}", i), shape_.filters, 1, x);
  }
  std::array<int, kLevels> sides{};
  for (int level = 0; level < kLevels; ++level) {
    if (level > 0) x = graph.add("pool", make_average_pool(graph.shape(x)), {x}, shape_.dropout);
    // The decoder begins with a dropout of what it is given.
    const float dropout = level + 1 == kLevels ? shape_.dropout : 0.0F;
    x = build.two_units(fmt::format("encoder.{}", level), shape_.filters << level, dropout, x);
    sides[level] = x;
  }
  for (int i = 0; i + 1 < kLevels; ++i) {
    const int level = kLevels - 2 - i;
    const std::string name = fmt::format("decoder.{}", i);
    const int up = build.up(name + ".up", shape_.filters << level, 2, x);
    const int both = graph.add(
        "side", make_concatenation(graph.shape(up), graph.shape(sides[level])), {up, sides[level]});
    const float dropout = level > 0 ? shape_.dropout : 0.0F;
    x = build.two_units(name, shape_.filters << level, dropout, both);
  }
  // With few filters all weights of the head may be negative at the start; without a bias its ReLU
  // would then be dead for good.
  constexpr float kHeadBias = 0.1F;
  const float deviation = std::sqrt(1.0F / static_cast<float>(shape_.filters));
  graph.add("head",
            {.negative_slope = 0.0F,
             .start_limit = std::numbers::sqrt3_v<float> * deviation,
             .start_bias = kHeadBias},
            {x});
  return std::move(build.graph);
}

}  // namespace hqslam::nn
