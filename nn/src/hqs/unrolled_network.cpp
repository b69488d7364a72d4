#include "unrolled_network.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "channels.h"
#include "hqslam/core/error.h"
#include "hqslam/nn/interpolation.h"
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
  UnrolledState state{{}, image, {image, image}, image, {}, {}};
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
  if (state.measured.rows != measured.rows) state.measured = RangeImage(measured.rows, columns_);
#pragma omp parallel num_threads(threads_)
  {
#pragma omp for schedule(static)
    for (int row = 0; row < measured.rows; ++row) {
      const float* from = &measured.range_m[measured.index(row, 0)];
      float* to = &state.measured.range_m[measured.index(row, 0)];
      for (int x = 0; x < columns_; ++x) to[x] = from[x] / description_.range_scale_m;
    }
#pragma omp for schedule(static)
    for (int row = 0; row < rows_; ++row) start_row(measured, row, state);
  }
}

void UnrolledNetwork::start_row(const RangeImage& measured, int row, UnrolledState& state) const {
  const TileSize tile = denoisers_.front()->tile();
  const RowsBetween between = rows_between(row, description_.measured_rows, measured.rows);
  const auto scaled_row = [&](int of) {
    return &state.measured.range_m[state.measured.index(of, 0)];
  };
  put_image_row(scaled_row(between.above), tile, row, state.candidates.above);
  put_image_row(scaled_row(between.below), tile, row, state.candidates.below);
  if (between.above == between.below) {  // a measured row; others of L are never looked at
    put_image_row(scaled_row(between.below), tile, row, state.l);
  }
  float* first = &state.raster[static_cast<std::size_t>(row) * columns_];
  if (options_.start == Start::kZero) {
    std::fill_n(first, columns_, 0.0F);
  } else if (between.above == between.below) {
    first = scaled_row(between.below);
  } else {
    interpolate_row(&measured.range_m[measured.index(between.above, 0)],
                    &measured.range_m[measured.index(between.below, 0)], between.part_down,
                    Interpolation::kLinear, columns_, first);
    for (int x = 0; x < columns_; ++x) first[x] /= description_.range_scale_m;
  }
  put_image_row(first, tile, row, state.z0);
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

bool UnrolledNetwork::filters_h() const { return options_.filtered == FilteredIterate::kH; }

void UnrolledNetwork::make_input(UnrolledState& state, int layer) const {
  const TileSize tile = denoisers_.front()->tile();
  const int memory = denoisers_.front()->memory_channels();
  Tensor& input = state.layer(layer).denoiser.input();
  const DataConsistency consistency = data_consistency(layer);
#pragma omp for schedule(static)
  for (int row = 0; row < input.rows(); ++row) {
    if (layer > 0 && has_filter_after(layer - 1)) set_y_row(row, state.layer(layer - 1));
    consistency.forward_row(state.l, previous_z(state, layer), previous_y(state, layer), row,
                            input);  // eq. 10a
    if (layer == 0) {
      clear_channels_row(tile.pixels(), row, input);  // no memory yet
    } else if (memory > 0) {
      const Tensor& before = state.layer(layer - 1).denoiser.output();
      copy_channels_row(before, before.channels() - memory, memory, row, input, tile.pixels());
    }
    if (has_filter_after(layer) && filters_h()) fill_raster_row(layer, row, state);
  }
}

/// Called by all threads of a parallel region. The fewer points at which they wait for each other,
/// the better: one thread looks for outliers while the others begin with the denoiser, whose first
/// results they all wait for.
void UnrolledNetwork::run_layer(UnrolledState& state, int layer,
                                std::optional<std::uint64_t> dropout_seed) {
  LayerState& current = state.layer(layer);
  const bool filter = has_filter_after(layer);
  make_input(state, layer);
  if (filter && filters_h()) {
#pragma omp single nowait
    filter_.find(state.raster.data(), current.rejected.data());  // eq. 10c
  }
  denoiser(layer).forward(state.candidates, current.denoiser, dropout_seed);  // eq. 10b
  if (filter && !filters_h()) {
#pragma omp for schedule(static)
    for (int row = 0; row < current.y.rows(); ++row) fill_raster_row(layer, row, state);
#pragma omp single
    filter_.find(state.raster.data(), current.rejected.data());
  }
}

/// The rows of the image that the filter of a layer looks at and that a row of tiles holds.
void UnrolledNetwork::fill_raster_row(int layer, int tile_row, UnrolledState& state) const {
  const DenoiserState& current = state.layer(layer).denoiser;
  const TileSize tile = denoisers_.front()->tile();
  // What is nearer than the sensor can see is no return.
  const auto nearest =
      static_cast<float>(description_.sensor.min_range_m) / description_.range_scale_m;
  for (int row = tile_row * tile.rows; row < (tile_row + 1) * tile.rows; ++row) {
    float* ranges = &state.raster[static_cast<std::size_t>(row) * columns_];
    take_image_row(filters_h() ? current.input() : current.z, tile, row, ranges);
    for (int x = 0; x < columns_; ++x) ranges[x] = ranges[x] >= nearest ? ranges[x] : 0.0F;
  }
}

void UnrolledNetwork::finish_last_layer(UnrolledState& state) {
  const int last = options_.layers - 1;
  LayerState& current = state.layer(last);
  for (int row = 0; row < current.y.rows(); ++row) fill_raster_row(last, row, state);
  filter_.find(state.raster.data(), current.rejected.data(), threads_);
  for (int row = 0; row < current.y.rows(); ++row) set_y_row(row, current);
}

void UnrolledNetwork::set_y_row(int row, LayerState& layer) const {
  const TileSize tile = denoisers_.front()->tile();
  const bool zero = options_.rejected == RejectedPixel::kZero;
  const Tensor& filtered = filters_h() ? layer.denoiser.input() : layer.denoiser.z;
  const float share_of_z = zero ? 0.0F : 1.0F;
  for_each_mask(layer.rejected, tile, columns_, row,
                [&](int channel, int first, int count, const std::uint32_t* mask) {
                  const float* kept = filtered.row(channel, row) + first;
                  const float* z = layer.denoiser.z.row(channel, row) + first;
                  float* y = layer.y.row(channel, row) + first;
#pragma omp simd
                  for (int i = 0; i < count; ++i) y[i] = mask[i] != 0 ? share_of_z * z[i] : kept[i];
                });
}

void UnrolledNetwork::forward(UnrolledState& state, std::optional<std::uint64_t> dropout_seed) {
#pragma omp parallel num_threads(threads_)
  for (int layer = 0; layer < options_.layers; ++layer) {
    const std::uint64_t seed = dropout_seed.value_or(0) * 1000 + layer * 10;
    run_layer(state, layer, dropout_seed ? std::optional(seed) : std::nullopt);
  }
}

std::vector<NetworkStep> UnrolledNetwork::steps(UnrolledState& state) {
  const int last = options_.layers - 1;
  DenoiserState& current = state.layer(last).denoiser;
  std::vector<NetworkStep> steps;
  steps.push_back(
      {"data consistency", options_.layers, 0, [this, last, &state] { make_input(state, last); }});
  for (NetworkStep& step : denoiser(last).steps(state.candidates, current)) {
    step.calls = options_.layers;
    steps.push_back(std::move(step));
  }
  if (last > 0 && has_filter_after(last - 1)) {
    steps.push_back({"outlier filter", last, 0,
                     [this, last, &state] {
                       filter_.find(state.raster.data(), state.layer(last - 1).rejected.data());
                     },
                     false});
  }
  return steps;
}

}  // namespace hqslam::nn
