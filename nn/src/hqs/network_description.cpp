#include "hqslam/nn/hqs/network_description.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "denoiser_layers.h"
#include "hqslam/core/error.h"
#include "two_modes_network.h"

namespace hqslam::nn {
namespace {

constexpr float kFirstPenalty = 0.1F;
constexpr float kFirstAlpha = 10.99F;  // as in the authors' code of Simple DU

bool is_mix(const NetworkDescription& d) { return d.kind == NetworkKind::kDuMix; }

std::unique_ptr<Denoiser> any_denoiser(const NetworkDescription& d) {
  if (d.kind == NetworkKind::kSimpleDu) {
    return make_plain_denoiser(d.plain, 1, 1, InstructionSet::kPortable, 1);
  }
  validate(d.u_shaped);
  const int halvings = 1 << (d.u_shaped.channels.size() - 1);
  return make_u_shaped_denoiser(d.u_shaped, d.u_shaped.tile.rows * halvings,
                                d.u_shaped.tile.columns * halvings, InstructionSet::kPortable, 1);
}

/// How many values the tensors of one layer hold, without their borders.
std::int64_t values_of_a_layer(const NetworkDescription& d) {
  const TileSize tile = tile_of(d);
  const std::int64_t places =
      static_cast<std::int64_t>(d.sensor.rows() / tile.rows) * (d.sensor.columns / tile.columns);
  if (is_mix(d)) {
    std::int64_t most = 0;
    for (const TwoModesLayerShape& layer : d.two_modes.layers) {
      const std::int64_t lower = (layer.residual_blocks + 2) * layer.lower_channels / 4;
      most = std::max(most, 2 * layer.channels + lower);
    }
    return places * (most + 13 * tile.pixels() + 2 * d.two_modes.memory);  // input, outputs, H, Z
  }
  if (d.kind == NetworkKind::kSimpleDu) {
    const std::int64_t hidden = d.plain.features * (d.plain.convolutions - 1);
    return places * (2 + hidden);  // and H and Z
  }
  const std::int64_t images = (2 + kSelectionGroups) * tile.pixels();  // H, Z and the scores
  std::int64_t values = places * (images + 2 * d.u_shaped.memory);
  for (std::size_t level = 0; level < d.u_shaped.channels.size(); ++level) {
    values += (places >> (2 * level)) * 2 * d.u_shaped.channels[level];  // on the way down and up
  }
  return values;
}

/// Memory for all layers is what training and a trace ask for.
void check_memory(const NetworkDescription& d) {
  constexpr std::int64_t kMostValues = std::int64_t{1} << 29U;  // 2 GiB
  const std::int64_t values = d.layers * values_of_a_layer(d);
  if (values > kMostValues) {
    throw Error(fmt::format(
        "network: {} layers on images of {} x {} hold {} values, expected at most {}; take fewer "
        "channels or layers or a sensor with fewer columns",
        d.layers, d.sensor.rows(), d.sensor.columns, values, kMostValues));
  }
}

void validate(const TwoModesShape& shape, const NetworkDescription& d) {
  constexpr int kMostChannels = 512;
  constexpr int kLargestTile = 16;
  constexpr int kMostBlocks = 32;
  check_field("tile.columns", shape.tile.columns, 1, kLargestTile);
  check_field("tile.rows", shape.tile.rows, 2, kLargestTile);
  check_field("memory", shape.memory, 0, kMostChannels);
  check_field("layers", static_cast<int>(shape.layers.size()), d.layers, d.layers);
  for (const TwoModesLayerShape& layer : shape.layers) {
    check_field("channels", layer.channels, 1, kMostChannels);
    check_field("lower_channels", layer.lower_channels, 1, kMostChannels);
    check_field("residual_blocks", layer.residual_blocks, 0, kMostBlocks);
  }
  if (!(shape.negative_slope >= 0.0F && shape.negative_slope <= 1.0F)) {
    throw Error(
        fmt::format("denoiser: negative_slope is {}, expected 0 to 1", shape.negative_slope));
  }
  if (shape.tile.rows != d.measured_rows.stride || d.measured_rows.offset >= shape.tile.rows ||
      d.sensor.rows() % (2 * shape.tile.rows) != 0) {
    throw Error(fmt::format(
        "denoiser: tiles of {} rows and measured rows {} + n {} of {}, expected one measured row "
        "in each tile and an even number of tiles",
        shape.tile.rows, d.measured_rows.offset, d.measured_rows.stride, d.sensor.rows()));
  }
  if (d.sensor.columns % (2 * shape.tile.columns) != 0) {
    throw Error(fmt::format("denoiser: an image of {} columns, expected a multiple of {}",
                            d.sensor.columns, 2 * shape.tile.columns));
  }
}

}  // namespace

std::string_view name(NetworkKind kind) {
  switch (kind) {
    case NetworkKind::kDuOr:
      return "du-or";
    case NetworkKind::kSimpleDu:
      return "simple-du";
    case NetworkKind::kDuMix:
      break;
  }
  return "du-mix";
}

TileSize tile_of(const NetworkDescription& d) {
  if (is_mix(d)) return d.two_modes.tile;
  return d.kind == NetworkKind::kDuOr ? d.u_shaped.tile : TileSize{};
}

void validate(const NetworkDescription& d) {
  constexpr int kMostLayers = 20;
  if (d.layers < 1 || d.layers > kMostLayers) {
    throw Error(fmt::format("network: layers is {}, expected 1 to {}", d.layers, kMostLayers));
  }
  if (!(d.range_scale_m > 0.0F) || !std::isfinite(d.range_scale_m)) {
    throw Error(fmt::format("network: range_scale_m is {}, expected above 0", d.range_scale_m));
  }
  validate(d.sensor);
  if (d.measured_rows.stride < 1 || d.measured_rows.stride > d.sensor.rows() ||
      d.measured_rows.offset < 0 || d.measured_rows.offset >= d.sensor.rows()) {
    throw Error(fmt::format("network: rows {} + n {} of {} are no selection",
                            d.measured_rows.offset, d.measured_rows.stride, d.sensor.rows()));
  }
  if (d.measured_rows == RowSelection{0, 1}) {
    throw Error(fmt::format(
        "network: all {} rows of sensor '{}' are measured, expected some to be computed; name the "
        "sensor with all rows, such as os1-64 for 16 measured ones",
        d.sensor.rows(), d.sensor.name));
  }
  switch (d.kind) {
    case NetworkKind::kDuOr:
      validate(d.u_shaped);
      break;
    case NetworkKind::kSimpleDu:
      validate(d.plain);
      break;
    case NetworkKind::kDuMix:
      validate(d.two_modes, d);
      break;
  }
  if (!(d.least_confidence >= 0.0F && d.least_confidence <= 1.0F)) {
    throw Error(
        fmt::format("network: least_confidence is {}, expected 0 to 1", d.least_confidence));
  }
  if (!(d.confidence_exponent > 0.0F && d.confidence_exponent <= 10.0F)) {
    throw Error(fmt::format("network: confidence_exponent is {}, expected above 0, at most 10",
                            d.confidence_exponent));
  }
  check_memory(d);
}

std::vector<ParameterShape> parameter_shapes(const NetworkDescription& d) {
  std::vector<ParameterShape> shapes;
  for (int layer = 0; layer < (d.shared_weights ? 1 : d.layers); ++layer) {
    for (ParameterShape shape :
         is_mix(d) ? two_modes_parameter_shapes(d, layer) : any_denoiser(d)->parameter_shapes()) {
      shape.name = fmt::format("layers.{}.{}", layer, shape.name);
      shapes.push_back(std::move(shape));
    }
  }
  if (d.kind == NetworkKind::kSimpleDu) {
    shapes.push_back({"alpha", {1}});
  } else if (d.kind == NetworkKind::kDuOr) {
    shapes.push_back({"log_penalty", {d.layers}});
  }
  return shapes;
}

std::vector<float> initial_parameters(const NetworkDescription& d, std::uint64_t seed) {
  std::vector<float> parameters;
  for (int layer = 0; layer < (d.shared_weights ? 1 : d.layers); ++layer) {
    const std::uint64_t of_layer = seed * 1000 + layer;
    const std::vector<float> of_one = is_mix(d) ? initial_two_modes_parameters(d, layer, of_layer)
                                                : any_denoiser(d)->initial_parameters(of_layer);
    parameters.insert(parameters.end(), of_one.begin(), of_one.end());
  }
  if (d.kind == NetworkKind::kSimpleDu) {
    parameters.push_back(kFirstAlpha);
  } else if (d.kind == NetworkKind::kDuOr) {
    parameters.insert(parameters.end(), d.layers, std::log(kFirstPenalty));
  }
  return parameters;
}

}  // namespace hqslam::nn
