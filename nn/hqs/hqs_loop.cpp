#include "hqs_loop.h"

#include <cmath>

#include "hqslam/core/error.h"
#include "parameters.h"

// The steps of the loop share their rows of tiles among the threads in the same way, so that what
// one does with a row finds what another left there without waiting. Only what needs a row's
// neighbours waits: the prior and the filter, for H.
namespace hqslam::nn {
namespace {

std::vector<std::unique_ptr<Prior>> make_priors(const NetworkDescription& d, int columns,
                                                const Engine& engine) {
  const HqsArchitecture& hqs = hqs_of(d);
  std::vector<std::unique_ptr<Prior>> priors;
  for (int i = 0; i < hqs.prior_count(); ++i) {
    priors.push_back(
        hqs.prior().make(hqs.prior().graph(d.sensor.rows(), columns, engine), d, columns, engine));
  }
  return priors;
}

/// The prior's own, or, made here, the usual one.
Measurement& measurement_of(const NetworkDescription& d, const HqsPreset& preset, Prior& prior,
                            std::unique_ptr<ScaledRanges>& scaled) {
  if (Measurement* own = prior.measurement()) return *own;
  scaled =
      std::make_unique<ScaledRanges>(d, prior.tile(), prior.make_tiles(), preset.starts_at_zero);
  return *scaled;
}

/// Z0 = Y0: what was measured, interpolated.
void start(Hqs& hqs) {
  const std::size_t floats = hqs.raster.size() / hqs.z0.rows();  // of a row of tiles
#pragma omp for schedule(static) nowait
  for (int row = 0; row < hqs.z0.rows(); ++row) {
    hqs.measurement.start_row(row, &hqs.raster[row * floats], hqs.z0);
  }
}

/// The rows of the image that a row of tiles holds, for the filter, which works without tiles.
void take_raster_row(Hqs& hqs, TileSize tile, int tile_row, const Tensor& h) {
  const int columns = h.columns() * tile.columns;
  for (int row = tile_row * tile.rows; row < (tile_row + 1) * tile.rows; ++row) {
    float* ranges = &hqs.raster[static_cast<std::size_t>(row) * columns];
    take_image_row(h, tile, row, ranges);
    for (int x = 0; x < columns; ++x) ranges[x] = ranges[x] >= hqs.nearest ? ranges[x] : 0.0F;
  }
}

/// Q: the pixels of H in small components. One thread finds them while the others begin with the
/// prior, whose first results all wait for.
void find_outliers_of_h(Hqs& hqs, int k, HqsState& state) {
#pragma omp single nowait
  hqs.filter.find(hqs.raster.data(), state.layer(k).rejected.data());
}

/// Q of Z, which all threads have just finished.
void find_outliers_of_z(Hqs& hqs, int k, HqsState& state) {
  HqsLayer& layer = state.layer(k);
#pragma omp for schedule(static)
  for (int row = 0; row < layer.prior.z.rows(); ++row) {
    take_raster_row(hqs, hqs.prior(k).tile(), row, layer.prior.z);
  }
#pragma omp single
  hqs.filter.find(hqs.raster.data(), layer.rejected.data());
}

/// Y: the filtered iterate (H, or Z), and in a rejected pixel the other one or the paper's 0.
void filter_step(Hqs& hqs, int k, HqsState& state) {
  HqsLayer& layer = state.layer(k);
  const Tensor& kept = hqs.of_h() ? layer.prior.h() : layer.prior.z;
  const Tensor& other = hqs.of_h() ? layer.prior.z : layer.prior.h();
  const float share = hqs.takes_other() ? 1.0F : 0.0F;
  const TileSize tile = hqs.prior(k).tile();
  const int columns = layer.y.columns() * tile.columns;
#pragma omp for schedule(static) nowait
  for (int row = 0; row < layer.y.rows(); ++row) {
    for_each_mask(layer.rejected, tile, columns, row,
                  [&](int channel, int first, int count, const std::uint32_t* mask) {
                    const float* from = kept.row(channel, row) + first;
                    const float* instead = other.row(channel, row) + first;
                    float* y = layer.y.row(channel, row) + first;
#pragma omp simd
                    for (int i = 0; i < count; ++i) {
                      y[i] = mask[i] != 0 ? share * instead[i] : from[i];
                    }
                  });
  }
}

}  // namespace

Hqs::Hqs(const NetworkDescription& d, int columns, const Engine& engine)
    : preset(hqs_of(d).preset()),
      sizes(hqs_of(d).sizes()),
      layers(sizes.layers),
      learns_penalty(hqs_of(d).learns_penalty()),
      priors(make_priors(d, columns, engine)),
      measurement(measurement_of(d, preset, *priors.front(), scaled)),
      penalty(layers, sizes.fixed_penalty.value_or(0.0F)),
      filter(d.sensor, d.measured_rows, sizes.filter, columns),
      nearest(static_cast<float>(d.sensor.min_range_m) / d.range_scale_m),
      z0(priors.front()->make_tiles()),
      raster(static_cast<std::size_t>(d.sensor.rows()) * columns) {}

void Hqs::set_parameters(std::span<const float> parameters) {
  const std::int64_t penalties = learns_penalty ? std::ssize(priors) : 0;
  const std::int64_t of_prior = prior(0).parameters();
  const std::int64_t expected = std::ssize(priors) * of_prior + penalties;
  if (std::ssize(parameters) != expected) {
    throw Error("network: {} parameters, expected {}", parameters.size(), expected);
  }
  for (const std::unique_ptr<Prior>& any : priors) any->set_parameters(take(parameters, of_prior));
  if (penalties == 0) return;
  alpha = parameters.back();
  for (int k = 0; k < layers; ++k) {
    penalty[k] = preset.learns_alpha ? 0.5F / alpha : std::exp(parameters[k % penalties]);
  }
}

HqsState Hqs::make_state(bool for_backward) const {
  HqsState state;
  for (int i = 0; i < (for_backward ? layers : std::min(2, layers)); ++i) {
    state.slots.push_back({prior(i).make_state(for_backward), has_y() ? z0 : Tensor{},
                           std::vector<std::uint8_t>(raster.size())});
  }
  return state;
}

void data_consistency_row(const float* l, const float* z, const float* y, float penalty,
                          int columns, float* h) {
  const float weight_l = 1.0F / (1.0F + 2.0F * penalty);
  const float weight_a = penalty / (1.0F + 2.0F * penalty);  // of Z + Y, not of their mean
  if (l != nullptr) {
    for (int x = 0; x < columns; ++x) h[x] = weight_l * l[x] + weight_a * (z[x] + y[x]);
  } else {
    for (int x = 0; x < columns; ++x) h[x] = 0.5F * (z[x] + y[x]);
  }
}

void recall_row(const float* m, const float* share, int columns, float* h) {
  for (int x = 0; x < columns; ++x) h[x] += share[x] * (m[x] - h[x]);
}

/// H = (L + b (Z + Y)) / (1 + 2 b) where a pixel was measured, otherwise (Z + Y) / 2, drawn towards
/// what is recalled.
void data_step(Hqs& hqs, int k, HqsState& state) {
  const TileSize tile = hqs.prior(k).tile();
  const Tensor& z = hqs.z_before(k, state);
  const Tensor& y = hqs.y_before(k, state);
  const PriorState* before = k == 0 ? nullptr : &state.layer(k - 1).prior;
  PriorState& current = state.layer(k).prior;
  Tensor& h = current.h();
  const bool filters_h = hqs.makes_y(k, state) && hqs.has_filter() && hqs.of_h();
#pragma omp for schedule(static)
  for (int row = 0; row < h.rows(); ++row) {
    for (int channel = 0; channel < tile.pixels(); ++channel) {
      data_consistency_row(hqs.measurement.l_row(channel, row), z.row(channel, row),
                           y.row(channel, row), hqs.penalty[k], h.columns(), h.row(channel, row));
      if (const RecalledRow recalled = hqs.measurement.recalled_row(channel, row); recalled.m) {
        recall_row(recalled.m, recalled.share, h.columns(), h.row(channel, row));
      }
      h.fill_border(channel, row);
    }
    hqs.prior(k).take_row(row, before, current);
    if (filters_h) take_raster_row(hqs, tile, row, h);
  }
}

void hqs_loop(Hqs& hqs, const Observation& seen, HqsState& state, const PriorPass& pass) {
  hqs.measurement.take(seen);  // L, and M and W where there is a memory
  start(hqs);                  // Z, Y
  for (int k = 0; k < hqs.layers; ++k) {
    const bool makes_y = hqs.makes_y(k, state);
    const bool filters = makes_y && hqs.has_filter();
    data_step(
        hqs, k,
        state);  // H = argmin |L - D H|^2 + |W (M - H)|^2 + b |Z - H|^2 + b |Y - H|^2     eq. 10a
    if (filters && hqs.of_h()) find_outliers_of_h(hqs, k, state);
    hqs.prior(k).forward(hqs.measurement.candidates(), state.layer(k).prior,
                         pass.of_layer(k));  // Z = G(H)                             eq. 10b
    if (filters && !hqs.of_h()) find_outliers_of_z(hqs, k, state);
    if (makes_y) filter_step(hqs, k, state);  // Y = H without its outliers           eq. 10c
  }
}

}  // namespace hqslam::nn
