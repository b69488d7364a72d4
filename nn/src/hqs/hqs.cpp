#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "../parameters.h"
#include "hqs_loop.h"
#include "hqslam/core/error.h"

namespace hqslam::nn {
namespace {

std::vector<std::unique_ptr<Prior>> make_priors(const NetworkDescription& d, int columns,
                                                const Engine& engine) {
  const HqsArchitecture& hqs = hqs_of(d);
  std::vector<std::unique_ptr<Prior>> priors;
  for (int i = 0; i < hqs.prior_count(); ++i) {
    priors.push_back(make_prior(hqs.prior(), d, d.sensor.rows(), columns, engine));
  }
  return priors;
}

/// The prior's own, or, made here, the usual one.
Measurement& measurement_of(const NetworkDescription& d, const HqsPreset& preset, Prior& prior,
                            std::unique_ptr<ScaledRanges>& scaled) {
  if (Measurement* own = prior.measurement()) return *own;
  scaled = std::make_unique<ScaledRanges>(d, prior.tile(), prior.make_state(false).z,
                                          preset.starts_at_zero);
  return *scaled;
}

}  // namespace

Hqs::Hqs(const NetworkDescription& d, int columns, const Engine& engine)
    : preset(hqs_of(d).preset()),
      layers(hqs_of(d).sizes().layers),
      priors(make_priors(d, columns, engine)),
      measurement(measurement_of(d, preset, *priors.front(), scaled)),
      penalty(layers),
      filter(d.sensor, d.measured_rows, hqs_of(d).sizes().filter, columns),
      nearest(static_cast<float>(d.sensor.min_range_m) / d.range_scale_m),
      z0(priors.front()->make_state(false).z),
      raster(static_cast<std::size_t>(d.sensor.rows()) * columns) {}

void Hqs::set_parameters(std::span<const float> parameters) {
  const std::int64_t penalties = !preset.learned_penalty ? 0 : preset.shared ? 1 : layers;
  const std::int64_t of_prior = prior(0).parameters();
  const std::int64_t expected = std::ssize(priors) * of_prior + penalties;
  if (std::ssize(parameters) != expected) {
    throw Error(fmt::format("network: {} parameters, expected {}", parameters.size(), expected));
  }
  for (const std::unique_ptr<Prior>& any : priors) any->set_parameters(take(parameters, of_prior));
  if (penalties == 0) return;
  alpha = parameters.back();
  for (int k = 0; k < layers; ++k) {
    penalty[k] = preset.shared ? 0.5F / alpha : std::exp(parameters[k]);
  }
}

HqsState Hqs::make_state(bool for_backward) const {
  HqsState state;
  for (int i = 0; i < (for_backward ? layers : std::min(2, layers)); ++i) {
    state.slots.push_back({prior(i).make_state(for_backward), preset.filters ? z0 : Tensor{},
                           std::vector<std::uint8_t>(raster.size())});
  }
  return state;
}

}  // namespace hqslam::nn
