#include "hqslam/nn/training/checkpoint.h"

#include <cmath>

#include "finite.h"
#include "hqslam/core/error.h"
#include "hqslam/core/npz.h"

namespace hqslam::nn {
namespace {

constexpr int kCurveColumns = 12;
constexpr std::int64_t kMostSteps = 1'000'000'000'000;  // times the batch this still fits

const NpzArray& member(const NpzArrays& arrays, const std::string& path, const std::string& name) {
  const auto found = arrays.find(name);
  if (found == arrays.end()) {
    throw Error("{}: expected a checkpoint with an array '{}', found none", path, name);
  }
  return found->second;
}

std::vector<float> finite_floats(const NpzArrays& arrays, const std::string& path,
                                 const std::string& name, std::size_t expected) {
  std::vector<float> values = float_values(member(arrays, path, name), path + ": " + name);
  if (values.size() != expected) {
    throw Error("{}: array '{}': expected {} values, found {}", path, name, expected,
                values.size());
  }
  return finite(std::move(values), path, name);
}

std::vector<double> finite_doubles(const NpzArrays& arrays, const std::string& path,
                                   const std::string& name) {
  return finite(double_values(member(arrays, path, name), path + ": " + name), path, name);
}

double loss_sum_of(const NpzArrays& arrays, const std::string& path) {
  const std::vector<double> values = finite_doubles(arrays, path, "loss_sum");
  if (values.size() != 1) {
    throw Error("{}: array 'loss_sum': expected one number, found {}", path, values.size());
  }
  return values[0];
}

std::vector<CurvePoint> curve_of(const NpzArrays& arrays, const std::string& path) {
  const std::vector<double> values = finite_doubles(arrays, path, "curve");
  if (values.size() % kCurveColumns != 0) {
    throw Error("{}: array 'curve': expected rows of {} values, found {} values", path,
                kCurveColumns, values.size());
  }
  std::vector<CurvePoint> curve;
  for (std::size_t i = 0; i < values.size(); i += kCurveColumns) {
    const double* v = &values[i];
    if (v[0] < 0.0 || v[0] > static_cast<double>(kMostSteps)) {
      throw Error("{}: array 'curve': expected steps of 0 to {}, found {}", path, kMostSteps, v[0]);
    }
    curve.push_back({std::llround(v[0]),
                     v[1],
                     {{v[2], v[3], v[4], v[5]}, {v[6], v[7], v[8], v[9]}, v[10], v[11]}});
  }
  return curve;
}

}  // namespace

void write_checkpoint(const std::string& path, const Checkpoint& checkpoint) {
  const auto parameters = static_cast<std::int64_t>(checkpoint.state.parameters.size());
  std::vector<double> curve;
  for (const CurvePoint& p : checkpoint.curve) {
    curve.insert(curve.end(), {static_cast<double>(p.step), p.loss});
    for (const ImageFigures& f : {p.validation.network, p.validation.linear}) {
      curve.insert(curve.end(), {f.mae_all_m, f.mae_valid_m, f.wrong_share, f.missing_share});
    }
    curve.insert(curve.end(), {p.validation.least_confidence, p.validation.confidence_exponent});
  }
  NpzArrays arrays;
  arrays["configuration"] = npz_text(checkpoint.configuration);
  arrays["steps"] = npz_array(std::vector<std::int64_t>{checkpoint.state.optimiser.steps}, {1});
  arrays["parameters"] = npz_array(checkpoint.state.parameters, {parameters});
  arrays["average"] = npz_array(checkpoint.state.average, {parameters});
  arrays["first_moment"] = npz_array(checkpoint.state.optimiser.first_moment, {parameters});
  arrays["second_moment"] = npz_array(checkpoint.state.optimiser.second_moment, {parameters});
  arrays["curve"] =
      npz_array(curve, {static_cast<std::int64_t>(checkpoint.curve.size()), kCurveColumns});
  arrays["loss_sum"] = npz_array(std::vector<double>{checkpoint.loss_sum}, {1});
  write_npz(path, arrays);
}

Checkpoint read_checkpoint(const std::string& path, const std::string& configuration,
                           const NetworkDescription& description, const AdamWOptions& adamw) {
  const auto parameters = static_cast<std::size_t>(elements(parameter_shapes(description)));
  const NpzArrays arrays = read_npz(path);
  if (text_value(member(arrays, path, "configuration"), path + ": configuration") !=
      configuration) {
    throw Error(
        "{}: the checkpoint is of another training configuration; train into another folder, or "
        "delete the checkpoint to begin anew",
        path);
  }
  const std::vector<std::int64_t> steps =
      int64_values(member(arrays, path, "steps"), path + ": steps");
  if (steps.size() != 1 || steps[0] < 0 || steps[0] > kMostSteps) {
    throw Error("{}: array 'steps': expected one number, 0 to {}", path, kMostSteps);
  }
  AdamW optimiser(adamw, parameters);
  optimiser.steps = steps[0];
  optimiser.first_moment = finite_floats(arrays, path, "first_moment", parameters);
  optimiser.second_moment = finite_floats(arrays, path, "second_moment", parameters);
  return {configuration,
          {finite_floats(arrays, path, "parameters", parameters), std::move(optimiser),
           finite_floats(arrays, path, "average", parameters)},
          curve_of(arrays, path),
          loss_sum_of(arrays, path)};
}

}  // namespace hqslam::nn
