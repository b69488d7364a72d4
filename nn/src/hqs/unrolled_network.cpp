#include "unrolled_network.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "channels.h"
#include "hqslam/core/error.h"
#include "hqslam/nn/hqs/interpolation.h"
#include "rejected_pixels.h"
#include "unrolled_hqs.h"

namespace hqslam::nn {
UnrolledNetwork::UnrolledNetwork(const NetworkDescription& description, int columns,
                                 InstructionSet instruction_set, int threads)
    : description_(description),
      options_(unrolled_hqs_of(description).options()),
      rows_(description.sensor.rows()),
      columns_(columns),
      threads_(threads),
      filter_(description.sensor, description.measured_rows, options_.filter, columns) {
  const UnrolledHqs& hqs = unrolled_hqs_of(description);
  for (int layer = 0; layer < hqs.denoiser_count(); ++layer) {
    denoisers_.push_back(make_denoiser(hqs.denoiser(), rows_, columns_, instruction_set, threads));
  }
  denoiser_parameters_ = elements(denoisers_.front()->parameter_shapes());
}

std::int64_t UnrolledNetwork::multiply_adds() const {
  return denoisers_.front()->multiply_adds() * options_.layers;
}

void UnrolledNetwork::set_parameters(std::span<const float> parameters) {
  const bool alpha = options_.penalty == Penalty::kAlpha;
  const std::size_t penalties = alpha ? 1 : options_.layers;
  const std::size_t expected = denoisers_.size() * denoiser_parameters_ + penalties;
  if (parameters.size() != expected) {
    throw Error(fmt::format("network: {} parameters, expected {}", parameters.size(), expected));
  }
  for (std::size_t i = 0; i < denoisers_.size(); ++i) {
    denoisers_[i]->set_parameters(
        parameters.subspan(i * denoiser_parameters_, denoiser_parameters_));
  }
  penalty_.clear();
  for (int layer = 0; layer < options_.layers; ++layer) {
    const float last = parameters[expected - penalties + (alpha ? 0 : layer)];
    penalty_.push_back(alpha ? 0.5F / last : std::exp(last));
    if (alpha) alpha_ = last;
  }
}

UnrolledState UnrolledNetwork::make_state(Kept kept) const {
  const Denoiser& denoiser = *denoisers_.front();
  const TileSize tile = denoiser.tile();
  const Tensor image(tile.pixels(), rows_ / tile.rows, columns_ / tile.columns, denoiser.padding());
  UnrolledState state{image, {image, image}, image, {}, {}};
  const std::size_t pixels = static_cast<std::size_t>(rows_) * columns_;
  const int slots = kept == Kept::kAllLayers ? options_.layers : std::min(2, options_.layers);
  for (int slot = 0; slot < slots; ++slot) {
    state.slots.push_back(
        {denoiser.make_state(kept == Kept::kAllLayers), image, std::vector<std::uint8_t>(pixels)});
  }
  state.raster.resize(pixels);
  return state;
}

void UnrolledNetwork::start(const RangeImage& measured, UnrolledState& state) const {
  if (measured.columns != columns_) {
    throw Error(fmt::format("network: a scan of {} x {}, expected {} columns", measured.rows,
                            measured.columns, columns_));
  }
  check_measured_rows(measured, description_.measured_rows, rows_);
#pragma omp parallel for schedule(static) num_threads(threads_)
  for (int row = 0; row < rows_; ++row) start_row(measured, row, state);
}

void UnrolledNetwork::start_row(const RangeImage& measured, int row, UnrolledState& state) const {
  const TileSize tile = denoisers_.front()->tile();
  const RowsBetween between = rows_between(row, description_.measured_rows, measured.rows);
  float* scaled = &state.raster[static_cast<std::size_t>(row) * columns_];
  const auto put = [&](int from_row, Tensor& tiles) {
    const float* from = &measured.range_m[measured.index(from_row, 0)];
    for (int x = 0; x < columns_; ++x) scaled[x] = from[x] / description_.range_scale_m;
    put_image_row(scaled, tile, row, tiles);
  };
  put(between.above, state.candidates.above);
  put(between.below, state.candidates.below);
  // In a measured row both neighbours are the row itself; the other rows of L are never looked at.
  put_image_row(scaled, tile, row, state.l);
  if (options_.start == Start::kZero) {
    std::fill_n(scaled, columns_, 0.0F);
  } else if (between.above != between.below) {
    interpolate_row(&measured.range_m[measured.index(between.above, 0)],
                    &measured.range_m[measured.index(between.below, 0)], between.part_down,
                    Interpolation::kLinear, columns_, scaled);
    for (int x = 0; x < columns_; ++x) scaled[x] /= description_.range_scale_m;
  }
  put_image_row(scaled, tile, row, state.z0);
}

DataConsistency UnrolledNetwork::data_consistency(int layer) const {
  return {denoisers_.front()->tile(), description_.measured_rows, penalty_[layer]};
}

const Tensor& UnrolledNetwork::previous_z(const UnrolledState& state, int layer) const {
  return layer == 0 ? state.z0 : state.layer(layer - 1).denoiser.z;
}

const Tensor& UnrolledNetwork::previous_y(const UnrolledState& state, int layer) const {
  if (options_.auxiliaries == Auxiliaries::kZ) return previous_z(state, layer);
  return layer == 0 ? state.z0 : state.layer(layer - 1).y;
}

void UnrolledNetwork::run_layer(UnrolledState& state, int layer,
                                std::optional<std::uint64_t> dropout_seed) {
  Denoiser& prior = denoiser(layer);
  const TileSize tile = prior.tile();
  DenoiserState& current = state.layer(layer).denoiser;
#pragma omp parallel num_threads(threads_)
  {
    data_consistency(layer).forward(state.l, previous_z(state, layer), previous_y(state, layer),
                                    current.input());  // eq. 10a
    if (layer == 0) {
      clear_channels(tile.pixels(), current.input());  // no memory yet
    } else if (prior.memory_channels() > 0) {
      const Tensor& before = state.layer(layer - 1).denoiser.output();
      copy_channels(before, before.channels() - prior.memory_channels(), prior.memory_channels(),
                    current.input(), tile.pixels());
    }
    prior.forward(state.candidates, current, dropout_seed);  // eq. 10b
    if (has_filter_after(layer)) fill_raster(state, layer);
  }
}

void UnrolledNetwork::fill_raster(UnrolledState& state, int layer) const {
  const DenoiserState& current = state.layer(layer).denoiser;
  const bool of_h = options_.filtered == FilteredIterate::kH;
  const TileSize tile = denoisers_.front()->tile();
  // What is nearer than the sensor can see is no return.
  const auto nearest =
      static_cast<float>(description_.sensor.min_range_m) / description_.range_scale_m;
#pragma omp for schedule(static)
  for (int row = 0; row < rows_; ++row) {
    float* ranges = &state.raster[static_cast<std::size_t>(row) * columns_];
    take_image_row(of_h ? current.input() : current.z, tile, row, ranges);
    for (int x = 0; x < columns_; ++x) ranges[x] = ranges[x] >= nearest ? ranges[x] : 0.0F;
  }
}

void UnrolledNetwork::remove_outliers(UnrolledState& state, int layer) {
  LayerState& current = state.layer(layer);
  filter_.find(state.raster.data(), current.rejected.data(), threads_);  // eq. 10c
#pragma omp parallel num_threads(threads_)
  set_y(current);
}

void UnrolledNetwork::finish_last_layer(UnrolledState& state) {
  const int last = options_.layers - 1;
#pragma omp parallel num_threads(threads_)
  fill_raster(state, last);
  remove_outliers(state, last);
}

void UnrolledNetwork::set_y(LayerState& layer) const {
  const TileSize tile = denoisers_.front()->tile();
  const bool of_h = options_.filtered == FilteredIterate::kH;
  const Tensor& filtered = of_h ? layer.denoiser.input() : layer.denoiser.z;
  const bool zero = options_.rejected == RejectedPixel::kZero;
#pragma omp for schedule(static)
  for (int row = 0; row < layer.y.rows(); ++row) {
    for (int channel = 0; channel < tile.pixels(); ++channel) {
      std::copy_n(filtered.row(channel, row), layer.y.columns(), layer.y.row(channel, row));
    }
    for_each_rejected(layer.rejected, tile, columns_, row, [&](int channel, int x) {
      layer.y.row(channel, row)[x] = zero ? 0.0F : layer.denoiser.z.row(channel, row)[x];
    });
  }
}

void UnrolledNetwork::forward(UnrolledState& state, std::optional<std::uint64_t> dropout_seed) {
  for (int layer = 0; layer < options_.layers; ++layer) {
    const std::uint64_t seed = dropout_seed.value_or(0) * 1000 + layer * 10;
    run_layer(state, layer, dropout_seed ? std::optional(seed) : std::nullopt);
    if (has_filter_after(layer)) remove_outliers(state, layer);
  }
}

std::vector<NetworkStep> UnrolledNetwork::steps(UnrolledState& state) {
  const int last = options_.layers - 1;
  const Tensor& z = previous_z(state, last);
  const Tensor& y = previous_y(state, last);
  DenoiserState& current = state.layer(last).denoiser;
  std::vector<NetworkStep> steps;
  steps.push_back({"data consistency", options_.layers, 0, [this, last, &state, &z, &y, &current] {
                     data_consistency(last).forward(state.l, z, y, current.input());
                   }});
  for (NetworkStep& step : denoiser(last).steps(state.candidates, current)) {
    step.calls = options_.layers;
    steps.push_back(std::move(step));
  }
  if (last > 0 && has_filter_after(last - 1)) {
    steps.push_back({"outlier filter", last, 0,
                     [this, last, &state] { remove_outliers(state, last - 1); }, false});
  }
  return steps;
}

}  // namespace hqslam::nn
