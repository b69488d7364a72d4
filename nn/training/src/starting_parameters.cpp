#include "hqslam/nn/training/starting_parameters.h"

#include <optional>

#include "hqslam/core/error.h"

namespace hqslam::nn {
namespace {

/// An array with more outputs or inputs than it had, which begin with zeros. Nothing if it does not
/// hold what there was.
std::optional<std::vector<float>> widened(const ParameterShape& from, const float* values,
                                          const ParameterShape& to) {
  const std::size_t rank = from.shape.size();
  if (from.name != to.name || rank != to.shape.size() || from.shape[0] > to.shape[0]) {
    return std::nullopt;
  }
  for (std::size_t i = 1; i < rank; ++i) {
    if (from.shape[i] != to.shape[i] && (i > 1 || from.shape[i] > to.shape[i])) return std::nullopt;
  }
  const std::int64_t of_output = from.elements() / from.shape[0];
  std::vector<float> result;
  for (std::int64_t output = 0; output < from.shape[0]; ++output, values += of_output) {
    result.insert(result.end(), values, values + of_output);
    result.resize((output + 1) * (to.elements() / to.shape[0]));
  }
  result.resize(to.elements());
  return result;
}

}  // namespace

std::vector<float> parameters_to_start_from(const Weights& weights,
                                            const NetworkDescription& network,
                                            const std::string& path) {
  const std::vector<ParameterShape> from = parameter_shapes(weights.description);
  const std::vector<ParameterShape> to = parameter_shapes(network);
  const bool learns_to_recall = has_scan_memory(network) && !has_scan_memory(weights.description);
  std::vector<float> parameters;
  const float* values = weights.parameters.data();
  bool fits = from.size() == to.size();
  for (std::size_t i = 0; fits && i < to.size(); values += from[i++].elements()) {
    const auto array = widened(from[i], values, to[i]);
    fits = array && (learns_to_recall || from[i].shape == to[i].shape);
    if (fits) parameters.insert(parameters.end(), array->begin(), array->end());
  }
  if (!fits) {
    throw Error(
        "{}: a network of kind {} with {} parameters, expected the one of the configuration, of {}",
        path, name(weights.description), weights.parameters.size(), elements(to));
  }
  return parameters;
}

}  // namespace hqslam::nn
