#include "du_mix.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "../parameters.h"
#include "filter_json.h"
#include "hqs_options.h"
#include "hqslam/core/error.h"
#include "two_modes_network.h"

namespace hqslam::nn {
namespace {

using Json = nlohmann::ordered_json;

TwoModesLayerShape read_layer(JsonFields fields) {
  TwoModesLayerShape shape;
  fields.optional("channels", shape.channels);
  fields.optional("lower_channels", shape.lower_channels);
  fields.optional("residual_blocks", shape.residual_blocks);
  fields.finish();
  return shape;
}

TwoModesShape read_shape(JsonFields fields) {
  TwoModesShape shape;
  fields.optional("tile_rows", shape.tile.rows);
  fields.optional("tile_columns", shape.tile.columns);
  fields.optional("memory", shape.memory);
  fields.optional("negative_slope", shape.negative_slope);
  if (fields.has("layers")) {
    shape.layers.clear();
    for (JsonFields& layer : fields.objects("layers")) {
      shape.layers.push_back(read_layer(std::move(layer)));
    }
  }
  fields.finish();
  return shape;
}

}  // namespace

DuMix::DuMix(TwoModesShape shape, const std::optional<OutlierRemovalOptions>& last_filter)
    : shape_(std::move(shape)), last_filter_(last_filter) {
  constexpr int kMostChannels = 512;
  constexpr int kLargestTile = 16;
  constexpr int kMostBlocks = 32;
  check_field("layers", static_cast<int>(shape_.layers.size()), 1, kMostLayers);
  check_field("tile.columns", shape_.tile.columns, 1, kLargestTile);
  check_field("tile.rows", shape_.tile.rows, 2, kLargestTile);
  check_field("memory", shape_.memory, 0, kMostChannels);
  for (const TwoModesLayerShape& layer : shape_.layers) {
    check_field("channels", layer.channels, 1, kMostChannels);
    check_field("lower_channels", layer.lower_channels, 1, kMostChannels);
    check_field("residual_blocks", layer.residual_blocks, 0, kMostBlocks);
  }
  check_slope(shape_.negative_slope);
}

void DuMix::write(Json& network) const {
  Json layers = Json::array();
  for (const TwoModesLayerShape& layer : shape_.layers) {
    layers.push_back({{"channels", layer.channels},
                      {"lower_channels", layer.lower_channels},
                      {"residual_blocks", layer.residual_blocks}});
  }
  network["denoiser"] = {{"tile_rows", shape_.tile.rows},
                         {"tile_columns", shape_.tile.columns},
                         {"memory", shape_.memory},
                         {"negative_slope", shape_.negative_slope},
                         {"layers", std::move(layers)}};
  if (last_filter_) network["last_filter"] = filter_json(*last_filter_);
}

std::shared_ptr<const Architecture> read_du_mix(JsonFields& network) {
  TwoModesShape shape;
  if (network.has("denoiser")) shape = read_shape(network.object("denoiser"));
  OutlierRemovalOptions last_filter;
  last_filter.min_pixels = 0;
  read_filter(network, "last_filter", last_filter);
  return std::make_shared<DuMix>(
      std::move(shape), last_filter.min_pixels != 0 ? std::optional(last_filter) : std::nullopt);
}

void DuMix::validate(const NetworkDescription& d) const {
  if (shape_.tile.rows != d.measured_rows.stride || d.measured_rows.offset >= shape_.tile.rows ||
      d.sensor.rows() % (2 * shape_.tile.rows) != 0) {
    throw Error(fmt::format(
        "denoiser: tiles of {} rows and measured rows {} + n {} of {}, expected one measured row "
        "in each tile and an even number of tiles",
        shape_.tile.rows, d.measured_rows.offset, d.measured_rows.stride, d.sensor.rows()));
  }
  std::int64_t of_a_tile = 0;
  for (const TwoModesLayerShape& layer : shape_.layers) {
    const std::int64_t lower = (layer.residual_blocks + 2) * layer.lower_channels / 4;
    of_a_tile += 2 * layer.channels + lower;
    of_a_tile += 13 * shape_.tile.pixels() + 2 * shape_.memory;  // input, outputs, H, Z
  }
  const std::int64_t tiles = static_cast<std::int64_t>(d.sensor.rows() / shape_.tile.rows) *
                             (d.sensor.columns / shape_.tile.columns);
  check_memory(tiles * of_a_tile, d);
}

/// A graph to ask about parameters.
LayerGraph DuMix::smallest_graph(const NetworkDescription& d, int layer) const {
  // Biases of rows are learned: as many rows as the sensor's images have.
  return two_modes_graph(shape_, layer, d.sensor.rows() / shape_.tile.rows, 2, {});
}

std::vector<ParameterShape> DuMix::parameter_shapes(const NetworkDescription& d) const {
  std::vector<ParameterShape> shapes;
  for (int layer = 0; layer < static_cast<int>(shape_.layers.size()); ++layer) {
    add_part(fmt::format("layers.{}", layer), smallest_graph(d, layer).parameter_shapes(), shapes);
  }
  return shapes;
}

std::vector<float> DuMix::initial_parameters(const NetworkDescription& d,
                                             std::uint64_t seed) const {
  std::vector<float> parameters;
  for (int layer = 0; layer < static_cast<int>(shape_.layers.size()); ++layer) {
    const std::vector<float> of_one =
        smallest_graph(d, layer).initial_parameters(seed * 1000 + layer);
    parameters.insert(parameters.end(), of_one.begin(), of_one.end());
  }
  return parameters;
}

std::unique_ptr<Network> DuMix::make_network(const NetworkDescription& d, int columns,
                                             InstructionSet instruction_set, int threads) const {
  return std::make_unique<TwoModesNetwork>(shape_, d, columns, instruction_set, threads);
}

}  // namespace hqslam::nn
