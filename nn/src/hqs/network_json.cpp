#include "hqslam/nn/hqs/network_json.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "../json_fields.h"
#include "hqslam/core/error.h"

namespace hqslam::nn {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegrees = 180.0 / std::numbers::pi;

void read_u_shaped(JsonFields fields, UShapedDenoiserShape& shape) {
  fields.optional("tile_rows", shape.tile.rows);
  fields.optional("tile_columns", shape.tile.columns);
  if (fields.has("channels")) shape.channels = fields.integers("channels");
  fields.optional("memory", shape.memory);
  fields.optional("negative_slope", shape.negative_slope);
  fields.finish();
}

void read_plain(JsonFields fields, PlainDenoiserShape& shape) {
  fields.optional("features", shape.features);
  fields.optional("convolutions", shape.convolutions);
  fields.optional("dropout", shape.dropout);
  fields.finish();
}

TwoModesLayerShape two_modes_layer(JsonFields fields) {
  TwoModesLayerShape shape;
  fields.optional("channels", shape.channels);
  fields.optional("lower_channels", shape.lower_channels);
  fields.optional("residual_blocks", shape.residual_blocks);
  fields.finish();
  return shape;
}

void read_two_modes(JsonFields fields, TwoModesShape& shape) {
  fields.optional("tile_rows", shape.tile.rows);
  fields.optional("tile_columns", shape.tile.columns);
  fields.optional("memory", shape.memory);
  fields.optional("negative_slope", shape.negative_slope);
  if (fields.has("layers")) {
    shape.layers.clear();
    for (JsonFields& layer : fields.objects("layers")) {
      shape.layers.push_back(two_modes_layer(std::move(layer)));
    }
  }
  fields.finish();
}

Json two_modes_json(const TwoModesShape& shape) {
  Json layers = Json::array();
  for (const TwoModesLayerShape& layer : shape.layers) {
    layers.push_back({{"channels", layer.channels},
                      {"lower_channels", layer.lower_channels},
                      {"residual_blocks", layer.residual_blocks}});
  }
  return {{"tile_rows", shape.tile.rows},
          {"tile_columns", shape.tile.columns},
          {"memory", shape.memory},
          {"negative_slope", shape.negative_slope},
          {"layers", std::move(layers)}};
}

Json u_shaped_json(const UShapedDenoiserShape& shape) {
  return {{"tile_rows", shape.tile.rows},
          {"tile_columns", shape.tile.columns},
          {"channels", shape.channels},
          {"memory", shape.memory},
          {"negative_slope", shape.negative_slope}};
}

Json plain_json(const PlainDenoiserShape& shape) {
  return {{"features", shape.features},
          {"convolutions", shape.convolutions},
          {"dropout", shape.dropout}};
}

Json denoiser_json(const NetworkDescription& d) {
  switch (d.kind) {
    case NetworkKind::kDuOr:
      return u_shaped_json(d.u_shaped);
    case NetworkKind::kSimpleDu:
      return plain_json(d.plain);
    case NetworkKind::kDuMix:
      break;
  }
  return two_modes_json(d.two_modes);
}

void read_denoiser(JsonFields fields, NetworkDescription& d) {
  switch (d.kind) {
    case NetworkKind::kDuOr:
      return read_u_shaped(std::move(fields), d.u_shaped);
    case NetworkKind::kSimpleDu:
      return read_plain(std::move(fields), d.plain);
    case NetworkKind::kDuMix:
      return read_two_modes(std::move(fields), d.two_modes);
  }
}

void read_filter(JsonFields fields, OutlierRemovalOptions& filter) {
  double min_angle_deg = filter.min_angle_rad * kDegrees;
  fields.optional("min_angle_deg", min_angle_deg);
  filter.min_angle_rad = min_angle_deg / kDegrees;
  fields.optional("min_pixels", filter.min_pixels);
  fields.optional("support_share", filter.support_share);
  fields.finish();
}

Json filter_json(const OutlierRemovalOptions& filter) {
  return {{"min_angle_deg", std::round(filter.min_angle_rad * kDegrees * 1e9) / 1e9},
          {"min_pixels", filter.min_pixels},
          {"support_share", std::round(filter.support_share * 1e6) / 1e6}};
}

SensorModel read_sensor(JsonFields& fields, const std::string& source) {
  const std::string text = fields.dumped("sensor");
  if (text.starts_with("\"")) {
    const std::string sensor = fields.text("sensor");
    const std::vector<std::string> presets = sensor_preset_names();
    if (std::find(presets.begin(), presets.end(), sensor) == presets.end()) {
      throw Error(fmt::format(
          "{}: sensor '{}' is none of {}; name one of them, or put what a sensor file says in its "
          "place",
          source, sensor, fmt::join(presets, ", ")));
    }
    return sensor_preset(sensor);
  }
  return sensor_from_json(text, source + ": sensor");
}

RowSelection read_rows(JsonFields& fields, int sensor_rows) {
  if (!fields.dumped("measured_rows").starts_with("{")) {
    int measured = 0;
    fields.optional("measured_rows", measured);
    if (measured < 1 || measured > sensor_rows || sensor_rows % measured != 0) {
      fields.complain("measured_rows", fmt::format("a number that divides {}", sensor_rows));
    }
    return selection_for(sensor_rows, measured);
  }
  JsonFields rows = fields.object("measured_rows");
  RowSelection selection;
  rows.optional("offset", selection.offset);
  rows.optional("stride", selection.stride);
  rows.finish();
  return selection;
}

/// What the networks that compute one range per pixel have beside it.
void read_image_options(JsonFields& fields, NetworkDescription& d) {
  fields.optional("range_scale_m", d.range_scale_m);
  if (fields.has("filter")) read_filter(fields.object("filter"), d.filter);
  d.last_filter = d.filter;
  if (fields.has("last_filter")) read_filter(fields.object("last_filter"), d.last_filter);
  if (fields.has("filtered_iterate")) {
    d.filtered = static_cast<FilteredIterate>(fields.choice("filtered_iterate", {"h", "z"}));
  }
  if (fields.has("rejected_pixel")) {
    d.rejected = static_cast<RejectedPixel>(fields.choice("rejected_pixel", {"takes-z", "zero"}));
  }
}

}  // namespace

NetworkDescription network_from_json(const std::string& text, const std::string& source) {
  JsonFields fields(text, source);
  NetworkDescription d;
  d.kind = static_cast<NetworkKind>(fields.choice("kind", {"du-or", "simple-du", "du-mix"}));
  d.shared_weights = d.kind == NetworkKind::kSimpleDu;
  if (d.kind != NetworkKind::kDuMix) {
    fields.optional("layers", d.layers);
    fields.optional("shared_weights", d.shared_weights);
  }
  const char* const denoiser = "denoiser";
  if (fields.has(denoiser)) read_denoiser(fields.object(denoiser), d);
  if (d.kind == NetworkKind::kDuMix) d.layers = static_cast<int>(d.two_modes.layers.size());
  d.sensor = read_sensor(fields, source);
  d.measured_rows = read_rows(fields, d.sensor.rows());
  if (d.kind == NetworkKind::kDuMix) {
    fields.optional("least_confidence", d.least_confidence);
    fields.optional("confidence_exponent", d.confidence_exponent);
    d.last_filter.min_pixels = 0;
    if (fields.has("last_filter")) read_filter(fields.object("last_filter"), d.last_filter);
  } else {
    read_image_options(fields, d);
  }
  fields.finish();
  try {
    validate(d);
  } catch (const Error& error) {
    throw Error(source + ": " + error.what());
  }
  return d;
}

std::string network_json(const NetworkDescription& d) {
  Json json;
  json["kind"] = name(d.kind);
  if (d.kind != NetworkKind::kDuMix) {
    json["layers"] = d.layers;
    json["shared_weights"] = d.shared_weights;
  }
  json["denoiser"] = denoiser_json(d);
  json["sensor"] = Json::parse(sensor_json(d.sensor));
  json["measured_rows"] = {{"offset", d.measured_rows.offset}, {"stride", d.measured_rows.stride}};
  if (d.kind == NetworkKind::kDuMix) {
    json["least_confidence"] = d.least_confidence;
    json["confidence_exponent"] = d.confidence_exponent;
    if (d.last_filter.min_pixels > 0) json["last_filter"] = filter_json(d.last_filter);
    return json.dump(1) + "\n";
  }
  json["range_scale_m"] = d.range_scale_m;
  json["filter"] = filter_json(d.filter);
  json["last_filter"] = filter_json(d.last_filter);
  json["filtered_iterate"] = d.filtered == FilteredIterate::kH ? "h" : "z";
  json["rejected_pixel"] = d.rejected == RejectedPixel::kTakesZ ? "takes-z" : "zero";
  return json.dump(1) + "\n";
}

}  // namespace hqslam::nn
