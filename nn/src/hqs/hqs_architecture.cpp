#include "hqs_architecture.h"

#include <fmt/format.h>

#include <cmath>

#include "../parameters.h"
#include "hqs_network.h"

namespace hqslam::nn {
namespace {

constexpr float kFirstPenalty = 0.1F;
constexpr float kFirstAlpha = 10.99F;  // as in the authors' code of Simple DU

/// How many values the tensors of one layer hold on an image as small as can be.
std::int64_t values_of_a_layer(const Prior& prior) {
  const PriorState state = prior.make_state();
  const auto values = [](const Tensor& t) {
    return static_cast<std::int64_t>(t.channels()) * t.rows() * t.columns();
  };
  std::int64_t sum = 2 * values(state.z);  // and Y
  for (const Tensor& tensor : state.values) sum += values(tensor);
  return sum;
}

}  // namespace

HqsArchitecture::HqsArchitecture(const HqsPreset& preset, const HqsSizes& sizes,
                                 PriorDescription prior)
    : preset_(preset), sizes_(sizes), prior_(std::move(prior)) {
  check_field("layers", sizes_.layers, 1, kMostLayers);
}

void HqsArchitecture::validate(const NetworkDescription& d) const {
  nn::validate(sizes_.filter);
  if (prior_.check) prior_.check(d);
  check_image(prior_, d.sensor.rows(), d.sensor.columns);
  const int rows = prior_.has_rows ? d.sensor.rows() : prior_.multiple.rows;
  const std::int64_t smallest_images = static_cast<std::int64_t>(d.sensor.rows() / rows) *
                                       (d.sensor.columns / prior_.multiple.columns);
  check_memory(sizes_.layers * values_of_a_layer(*smallest_prior(prior_, d)) * smallest_images, d);
}

std::vector<ParameterShape> HqsArchitecture::parameter_shapes(const NetworkDescription& d) const {
  const std::vector<ParameterShape> of_one = smallest_prior(prior_, d)->parameter_shapes();
  std::vector<ParameterShape> shapes;
  for (int layer = 0; layer < prior_count(); ++layer) {
    add_part(fmt::format("layers.{}", layer), of_one, shapes);
  }
  if (penalty_count() > 0) {
    shapes.push_back({preset_.shared ? "alpha" : "log_penalty", {penalty_count()}});
  }
  return shapes;
}

std::vector<float> HqsArchitecture::initial_parameters(const NetworkDescription& d,
                                                       std::uint64_t seed) const {
  const std::unique_ptr<Prior> prior = smallest_prior(prior_, d);
  std::vector<float> parameters;
  for (int layer = 0; layer < prior_count(); ++layer) {
    const std::vector<float> of_one = prior->initial_parameters(seed * 1000 + layer);
    parameters.insert(parameters.end(), of_one.begin(), of_one.end());
  }
  parameters.insert(parameters.end(), penalty_count(),
                    preset_.shared ? kFirstAlpha : std::log(kFirstPenalty));
  return parameters;
}

std::unique_ptr<Network> HqsArchitecture::make_network(const NetworkDescription& d, int columns,
                                                       InstructionSet instruction_set,
                                                       int threads) const {
  return std::make_unique<HqsNetwork>(d, columns, instruction_set, threads);
}

std::optional<OutlierRemovalOptions> HqsArchitecture::last_filter() const {
  if (sizes_.last_filter.min_pixels == 0) return std::nullopt;
  return sizes_.last_filter;
}

const HqsArchitecture& hqs_of(const NetworkDescription& description) {
  return dynamic_cast<const HqsArchitecture&>(*description.architecture);
}

}  // namespace hqslam::nn
