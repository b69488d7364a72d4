#include "hqslam/nn/network_json.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "architecture.h"
#include "hqslam/core/error.h"
#include "hqslam/core/json_fields.h"

namespace hqslam::nn {
namespace {

using Json = nlohmann::ordered_json;

std::shared_ptr<const Architecture> read_architecture(JsonFields& fields,
                                                      const Architectures& architectures) {
  std::vector<std::string> names;
  for (const NamedArchitecture& named : architectures) names.emplace_back(named.name);
  return architectures[fields.choice("kind", names)].read(fields);
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

}  // namespace

SensorModel read_sensor_field(const char* field, const std::string& source, JsonFields& fields) {
  const std::string text = fields.dumped(field);
  if (text.starts_with("\"")) {
    const std::string sensor = fields.text(field);
    const std::vector<std::string> presets = sensor_preset_names();
    if (std::ranges::find(presets, sensor) == presets.end()) {
      throw Error(
          "{}: {} '{}' is none of {}; name one of them, or put the content of a sensor file in "
          "its place",
          source, field, sensor, fmt::join(presets, ", "));
    }
    return sensor_preset(sensor);
  }
  return sensor_from_json(text, fmt::format("{}: {}", source, field));
}

NetworkDescription network_from_json(const std::string& text, const std::string& source,
                                     const Architectures& architectures) {
  JsonFields fields(text, source);
  NetworkDescription d;
  try {
    d.architecture = read_architecture(fields, architectures);
    d.sensor = read_sensor_field("sensor", source, fields);
    d.measured_rows = read_rows(fields, d.sensor.rows());
    fields.optional("range_scale_m", d.range_scale_m);
    if (has_confidence(d)) {
      fields.optional("least_confidence", d.least_confidence);
      fields.optional("confidence_exponent", d.confidence_exponent);
    }
    fields.finish();
    validate(d);
  } catch (const Error& error) {
    // Errors about a field's type have the source, those about its value do not.
    const std::string message = error.what();
    throw Error(message.starts_with(source) ? message : source + ": " + message);
  }
  return d;
}

std::string network_json(const NetworkDescription& d) {
  Json json;
  json["kind"] = name(d);
  json["sensor"] = Json::parse(sensor_json(d.sensor));
  json["measured_rows"] = {{"offset", d.measured_rows.offset}, {"stride", d.measured_rows.stride}};
  json["range_scale_m"] = d.range_scale_m;
  if (has_confidence(d)) {
    json["least_confidence"] = d.least_confidence;
    json["confidence_exponent"] = d.confidence_exponent;
  }
  d.architecture->write(json);
  return json.dump(1) + "\n";
}

}  // namespace hqslam::nn
