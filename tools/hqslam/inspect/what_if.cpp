#include "inspect/what_if.h"

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <sstream>

#include "hqslam/core/error.h"
#include "hqslam/core/words.h"
#include "hqslam/nn/network_json.h"

namespace hqslam::tools {
namespace {

using Json = nlohmann::ordered_json;

template <typename Number>
Number number_of(const std::string& text, const std::string& change) {
  const auto value = number_from<Number>(text);
  if (!value) throw Error("--what-if {}: '{}' is no number", change, text);
  return *value;
}

/// The value after "NAME=", if that is what the change is.
std::optional<std::string> value_of(const std::string& change, const std::string& name) {
  if (!change.starts_with(name + "=")) return std::nullopt;
  return change.substr(name.size() + 1);
}

/// What a rejected pixel takes has two names for one choice: of H's filter Z, of Z's filter H.
void rename_other(Json& network) {
  if (network["rejected_pixel"] == "zero") return;
  network["rejected_pixel"] = network["filtered_iterate"] == "h" ? "takes-z" : "takes-h";
}

void apply(const std::string& change, int layers, Json& network) {
  if (const auto b = value_of(change, "b")) {
    network["penalty"] = number_of<double>(*b, change);
  } else if (const auto count = value_of(change, "layers")) {
    network["layers"] = number_of<int>(*count, change);
    if (network["layers"] > layers) {
      throw Error("--what-if {}: expected 1 to {}, as many as were trained", change, layers);
    }
  } else if (change == "y=zero" || change == "y=other") {
    network["rejected_pixel"] = change == "y=zero" ? "zero" : "other";
  } else if (change == "q=z" || change == "q=h") {
    network["filtered_iterate"] = change.substr(2);
  } else if (const auto angle = value_of(change, "angle")) {
    network["filter"]["min_angle_deg"] = number_of<double>(*angle, change);
  } else if (const auto pixels = value_of(change, "pixels")) {
    network["filter"]["min_pixels"] = number_of<int>(*pixels, change);
  } else if (change == "no-q") {
    network["filter"]["min_pixels"] = 0;
  } else if (change == "literal") {
    network["rejected_pixel"] = "zero";
    network["filtered_iterate"] = "h";
    network["denoiser"]["neighbours"] = "h";
  } else {
    throw Error(
        "--what-if {}: expected b=NUMBER, layers=N, y=zero, y=other, q=z, q=h, angle=DEGREES, "
        "pixels=N, no-q or literal",
        change);
  }
  rename_other(network);
}

/// The parameters of the arrays that the changed network has; of longer arrays (the penalties of
/// layers) the first ones.
std::vector<float> parameters_of(const nn::NetworkDescription& changed,
                                 const nn::Weights& weights) {
  std::map<std::string, std::span<const float>> trained;
  std::span<const float> rest = weights.parameters;
  for (const nn::ParameterShape& shape : nn::parameter_shapes(weights.description)) {
    trained[shape.name] = rest.first(shape.elements());
    rest = rest.subspan(shape.elements());
  }
  std::vector<float> parameters;
  for (const nn::ParameterShape& shape : nn::parameter_shapes(changed)) {
    const std::span<const float> values = trained.at(shape.name).first(shape.elements());
    parameters.insert(parameters.end(), values.begin(), values.end());
  }
  return parameters;
}

}  // namespace

nn::Weights what_if(const nn::Weights& weights, const std::string& change) {
  Json network = Json::parse(nn::network_json(weights.description));
  if (!network.contains("rejected_pixel") || network["kind"] != "du-or") {
    throw Error("--what-if: {} has no such settings, expected weights of du-or",
                nn::name(weights.description));
  }
  const int layers = network["layers"];
  std::istringstream changes(change);
  for (std::string one; std::getline(changes, one, ',');) apply(one, layers, network);
  nn::Weights changed;
  changed.description = nn::network_from_json(network.dump(), "--what-if " + change);
  changed.parameters = parameters_of(changed.description, weights);
  return changed;
}

}  // namespace hqslam::tools
