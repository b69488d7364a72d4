#include "unrolled_hqs.h"

#include <fmt/format.h>

#include <cmath>

#include "../parameters.h"
#include "unrolled_lifter.h"

namespace hqslam::nn {
namespace {

constexpr float kFirstPenalty = 0.1F;
constexpr float kFirstAlpha = 10.99F;  // as in the authors' code of Simple DU

/// How many values the tensors of one layer hold on an image as small as can be.
std::int64_t values_of_a_layer(const DenoiserDescription& description) {
  const DenoiserState state = smallest_denoiser(description)->make_state();
  const auto values = [](const Tensor& t) {
    return static_cast<std::int64_t>(t.channels()) * t.rows() * t.columns();
  };
  std::int64_t sum = 2 * values(state.z);  // and Y
  for (const Tensor& tensor : state.values) sum += values(tensor);
  return sum;
}

}  // namespace

UnrolledHqs::UnrolledHqs(std::string kind, const HqsOptions& options, DenoiserDescription denoiser)
    : kind_(std::move(kind)), options_(options), denoiser_(std::move(denoiser)) {
  check_field("layers", options.layers, 1, kMostLayers);
}

void UnrolledHqs::validate(const NetworkDescription& d) const {
  nn::validate(options_.filter);
  const TileSize multiple = denoiser_.multiple;
  check_image(denoiser_, d.sensor.rows(), d.sensor.columns);
  const std::int64_t smallest_images = static_cast<std::int64_t>(d.sensor.rows() / multiple.rows) *
                                       (d.sensor.columns / multiple.columns);
  check_memory(options_.layers * values_of_a_layer(denoiser_) * smallest_images, d);
}

std::vector<ParameterShape> UnrolledHqs::parameter_shapes(const NetworkDescription&) const {
  const std::vector<ParameterShape> of_one = smallest_denoiser(denoiser_)->parameter_shapes();
  std::vector<ParameterShape> shapes;
  for (int layer = 0; layer < denoiser_count(); ++layer) {
    add_part(fmt::format("layers.{}", layer), of_one, shapes);
  }
  shapes.push_back(
      {options_.penalty == Penalty::kAlpha ? "alpha" : "log_penalty", {penalty_count()}});
  return shapes;
}

std::vector<float> UnrolledHqs::initial_parameters(const NetworkDescription&,
                                                   std::uint64_t seed) const {
  const std::unique_ptr<Denoiser> denoiser = smallest_denoiser(denoiser_);
  std::vector<float> parameters;
  for (int layer = 0; layer < denoiser_count(); ++layer) {
    const std::vector<float> of_one = denoiser->initial_parameters(seed * 1000 + layer);
    parameters.insert(parameters.end(), of_one.begin(), of_one.end());
  }
  const bool alpha = options_.penalty == Penalty::kAlpha;
  parameters.insert(parameters.end(), penalty_count(),
                    alpha ? kFirstAlpha : std::log(kFirstPenalty));
  return parameters;
}

std::unique_ptr<Network> UnrolledHqs::make_network(const NetworkDescription& d, int columns,
                                                   InstructionSet instruction_set,
                                                   int threads) const {
  return std::make_unique<UnrolledLifter>(d, columns, instruction_set, threads);
}

std::optional<OutlierRemovalOptions> UnrolledHqs::last_filter() const {
  if (options_.last_filter.min_pixels == 0) return std::nullopt;
  return options_.last_filter;
}

const UnrolledHqs& unrolled_hqs_of(const NetworkDescription& description) {
  return dynamic_cast<const UnrolledHqs&>(*description.architecture);
}

}  // namespace hqslam::nn
