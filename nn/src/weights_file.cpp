#include "hqslam/nn/weights_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "finite.h"
#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "hqslam/core/json_fields.h"
#include "hqslam/core/npz.h"
#include "hqslam/nn/interpolation.h"
#include "hqslam/nn/network.h"
#include "hqslam/nn/network_json.h"

namespace hqslam::nn {
namespace {

constexpr std::int64_t kLargestBytes = 256LL << 20;
constexpr const char* kFormat = "hqslam-weights-1";
constexpr const char* kDescription = "description";
constexpr const char* kMeasured = "self_test.measured";
constexpr const char* kExpected = "self_test.expected";

/// The values of the array of that name, which must have that shape; taken out of `arrays`.
std::vector<float> take_floats(const std::string& path, const std::string& name,
                               const std::vector<std::int64_t>& shape, NpzArrays& arrays) {
  const auto found = arrays.find(name);
  if (found == arrays.end()) {
    throw Error("{}: expected an array '{}' of {}, found none", path, name, fmt::join(shape, "x"));
  }
  const NpzArray& array = found->second;
  if (array.shape != shape) {
    throw Error("{}: array '{}': expected shape {}, found {}", path, name, fmt::join(shape, "x"),
                fmt::join(array.shape, "x"));
  }
  const std::string source = fmt::format("{}: {}", path, name);
  std::vector<float> values;
  if (array.dtype == "<f8") {  // PyTorch in double precision
    const std::vector<double> wide = double_values(array, source);
    values.assign(wide.begin(), wide.end());
  } else {
    values = float_values(array, source);
  }
  arrays.erase(found);
  return finite(std::move(values), path, name);
}

RangeImage take_image(const std::string& path, const std::string& name, int rows, int columns,
                      NpzArrays& arrays) {
  RangeImage image(rows, columns);
  image.range_m = take_floats(path, name, {rows, columns}, arrays);
  return image;
}

std::vector<float> take_parameters(const std::string& path, const NetworkDescription& description,
                                   NpzArrays& arrays) {
  std::vector<float> parameters;
  for (const ParameterShape& shape : parameter_shapes(description)) {
    const std::vector<float> values = take_floats(path, shape.name, shape.shape, arrays);
    parameters.insert(parameters.end(), values.begin(), values.end());
  }
  return parameters;
}

SelfTest take_self_test(const std::string& path, const NetworkDescription& d, NpzArrays& arrays) {
  const int columns = d.sensor.columns;
  return {take_image(path, kMeasured, measured_row_count(d.sensor.rows(), d.measured_rows), columns,
                     arrays),
          take_image(path, kExpected, d.sensor.rows(), columns, arrays)};
}

void check_nothing_left(const std::string& path, const NetworkDescription& description,
                        const NpzArrays& arrays) {
  if (arrays.empty()) return;
  throw Error("{}: unknown array '{}' for a network of kind {}", path,
              excerpt(arrays.begin()->first), name(description));
}

/// Throws Error unless there are as many parameters as the network has.
void check_parameter_count(const std::string& path, const Weights& weights) {
  const std::int64_t expected = elements(parameter_shapes(weights.description));
  if (static_cast<std::int64_t>(weights.parameters.size()) != expected) {
    throw Error(
        "{}: expected {} parameters for a network of kind {}, found {}; write the weights with the "
        "description that they were trained with",
        path, expected, name(weights.description), weights.parameters.size());
  }
}

}  // namespace

SelfTest make_self_test(Network& network, const RangeImage& measured) {
  return {measured, network.estimate(measured)};
}

Weights read_weights(const std::string& path, const Architectures& architectures) {
  NpzArrays arrays = read_npz(path, kLargestBytes);
  const auto description = arrays.find(kDescription);
  if (description == arrays.end()) {
    throw Error(
        "{}: expected weights with a member 'description', found none; make weights with "
        "hqslam-lab "
        "train, or from another program's arrays with hqslam weights pack",
        path);
  }
  JsonFields fields(text_value(description->second, fmt::format("{}: description", path)),
                    path + ": description");
  arrays.erase(description);
  fields.choice("format", {kFormat});
  Weights weights;
  weights.description =
      network_from_json(fields.dumped("network"), path + ": network", architectures);
  weights.training = fields.dumped("training");
  fields.finish();
  weights.parameters = take_parameters(path, weights.description, arrays);
  weights.self_test = take_self_test(path, weights.description, arrays);
  check_nothing_left(path, weights.description, arrays);
  return weights;
}

ForeignArrays read_foreign_arrays(const std::string& path, const NetworkDescription& description) {
  NpzArrays arrays = read_npz(path, kLargestBytes);
  ForeignArrays foreign{take_parameters(path, description, arrays), std::nullopt};
  if (arrays.count(kMeasured) > 0 || arrays.count(kExpected) > 0) {
    foreign.self_test = take_self_test(path, description, arrays);
  }
  check_nothing_left(path, description, arrays);
  return foreign;
}

void write_weights(const std::string& path, const Weights& weights) {
  const NetworkDescription& d = weights.description;
  check_parameter_count(path, weights);
  nlohmann::ordered_json json;
  json["format"] = kFormat;
  json["network"] = nlohmann::ordered_json::parse(network_json(d));
  json["training"] = parsed_json(weights.training, path + ": training");
  NpzArrays arrays;
  arrays[kDescription] = npz_text(json.dump(1) + "\n");
  auto next = weights.parameters.begin();
  for (const ParameterShape& shape : parameter_shapes(d)) {
    const auto end = next + shape.elements();
    arrays[shape.name] = npz_array(std::vector<float>(next, end), shape.shape);
    next = end;
  }
  const auto image = [](const RangeImage& i) { return npz_array(i.range_m, {i.rows, i.columns}); };
  arrays[kMeasured] = image(weights.self_test.measured);
  arrays[kExpected] = image(weights.self_test.expected);
  write_npz(path, arrays);
}

void check_self_test(Network& network, const NetworkDescription& d, const SelfTest& self_test,
                     const std::string& path, float tolerance) {
  const RangeImage z = network.estimate(self_test.measured);
  const RangeImage& expected = self_test.expected;
  if (expected.range_m.size() != z.range_m.size()) {
    throw Error(
        "{}: self-test: expected ranges of {} pixels, found {}; make it with make_self_test of the "
        "same network",
        path, z.range_m.size(), expected.range_m.size());
  }
  // The filter inside decides at thresholds: a rounding error may tip a single component, so a few
  // pixels may differ; the rest must agree.
  const float tolerance_m = tolerance * d.range_scale_m;
  constexpr double kLargestShare = 0.001;
  std::int64_t differing = 0;
  for (std::size_t i = 0; i < z.range_m.size(); ++i) {
    if (!(std::abs(z.range_m[i] - expected.range_m[i]) <= tolerance_m)) ++differing;
  }
  const auto allowed =
      static_cast<std::int64_t>(kLargestShare * static_cast<double>(z.range_m.size()));
  if (differing > allowed) {
    throw Error(
        "{}: self-test: {} of {} pixels differ from what the network gave where it was trained, "
        "expected at most {}; the file was changed or is damaged",
        path, differing, z.range_m.size(), allowed);
  }
}

}  // namespace hqslam::nn
