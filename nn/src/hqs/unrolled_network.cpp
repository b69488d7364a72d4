#include "hqslam/nn/hqs/unrolled_network.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "hqslam/core/error.h"
#include "hqslam/nn/hqs/interpolation.h"

namespace hqslam::nn {
namespace {

int checked_columns(const NetworkDescription& description, int columns) {
  validate(description);
  if (columns < 1 || columns > description.sensor.columns) {
    throw Error(fmt::format("network: images of {} columns, expected 1 to {}", columns,
                            description.sensor.columns));
  }
  return columns;
}

/// Rows of the channels from `from_channel` on, borders too.
void copy_channels(const Tensor& from, int from_channel, int channels, Tensor& to, int to_channel) {
#pragma omp for schedule(static)
  for (int row = 0; row < to.rows(); ++row) {
    for (int channel = 0; channel < channels; ++channel) {
      std::copy_n(from.row(from_channel + channel, row), to.columns(),
                  to.row(to_channel + channel, row));
      to.fill_border(to_channel + channel, row);
    }
  }
}

/// The first `channels` channels of `from` are added to those of `to`.
void add_tiles(const Tensor& from, int channels, Tensor& to) {
  for (int channel = 0; channel < channels; ++channel) {
    for (int row = 0; row < to.rows(); ++row) {
      const float* from_row = from.row(channel, row);
      float* to_row = to.row(channel, row);
      for (int x = 0; x < to.columns(); ++x) to_row[x] += from_row[x];
    }
  }
}

/// Zero from channel `from_channel` on, borders too.
void clear_channels(int from_channel, Tensor& tensor) {
#pragma omp for schedule(static)
  for (int row = 0; row < tensor.rows(); ++row) {
    for (int channel = from_channel; channel < tensor.channels(); ++channel) {
      std::fill_n(tensor.row(channel, row), tensor.columns(), 0.0F);
      tensor.fill_border(channel, row);
    }
  }
}

}  // namespace

UnrolledNetwork::UnrolledNetwork(const NetworkDescription& description, int columns,
                                 InstructionSet instruction_set, int threads)
    : description_(description),
      rows_(description.sensor.rows()),
      columns_(checked_columns(description, columns)),
      threads_(threads),
      filter_(description.sensor, description.measured_rows, description.filter, columns) {
  for (int layer = 0; layer < (description_.shared_weights ? 1 : description_.layers); ++layer) {
    denoisers_.push_back(
        description_.kind == NetworkKind::kDuOr
            ? make_u_shaped_denoiser(description_.u_shaped, rows_, columns_, instruction_set,
                                     threads)
            : make_plain_denoiser(description_.plain, rows_, columns_, instruction_set, threads));
  }
  for (const ParameterShape& shape : denoisers_.front()->parameter_shapes()) {
    denoiser_parameters_ += shape.elements();
  }
}

std::int64_t UnrolledNetwork::multiply_adds() const {
  return denoisers_.front()->multiply_adds() * description_.layers;
}

void UnrolledNetwork::set_parameters(std::span<const float> parameters) {
  const bool simple = description_.kind == NetworkKind::kSimpleDu;
  const std::size_t penalties = simple ? 1 : description_.layers;
  const std::size_t expected = denoisers_.size() * denoiser_parameters_ + penalties;
  if (parameters.size() != expected) {
    throw Error(fmt::format("network: {} parameters, expected {}", parameters.size(), expected));
  }
  for (std::size_t i = 0; i < denoisers_.size(); ++i) {
    denoisers_[i]->set_parameters(
        parameters.subspan(i * denoiser_parameters_, denoiser_parameters_));
  }
  penalty_.clear();
  for (int layer = 0; layer < description_.layers; ++layer) {
    const float last = parameters[expected - penalties + (simple ? 0 : layer)];
    penalty_.push_back(simple ? 0.5F / last : std::exp(last));
    if (simple) alpha_ = last;
  }
}

UnrolledState UnrolledNetwork::make_state(Kept kept) const {
  const Denoiser& denoiser = *denoisers_.front();
  const TileSize tile = denoiser.tile();
  const Tensor image(tile.pixels(), rows_ / tile.rows, columns_ / tile.columns, denoiser.padding());
  UnrolledState state{image, {image, image}, image, {}, {}};
  const std::size_t pixels = static_cast<std::size_t>(rows_) * columns_;
  const int slots =
      kept == Kept::kAllLayers ? description_.layers : std::min(2, description_.layers);
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
  if (description_.kind == NetworkKind::kSimpleDu) {
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
  if (description_.kind == NetworkKind::kSimpleDu) return previous_z(state, layer);
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
                                    current.input);  // eq. 10a
    if (layer == 0) {
      clear_channels(tile.pixels(), current.input);  // no memory yet
    } else if (prior.memory_channels() > 0) {
      const Tensor& before = state.layer(layer - 1).denoiser.output;
      copy_channels(before, before.channels() - prior.memory_channels(), prior.memory_channels(),
                    current.input, tile.pixels());
    }
    prior.forward(state.candidates, current, dropout_seed);  // eq. 10b
    if (has_filter_after(layer)) fill_raster(state, layer);
  }
}

void UnrolledNetwork::fill_raster(UnrolledState& state, int layer) const {
  const DenoiserState& current = state.layer(layer).denoiser;
  const bool of_h = description_.filtered == FilteredIterate::kH;
  const TileSize tile = denoisers_.front()->tile();
  // What is nearer than the sensor can see is no return.
  const auto nearest =
      static_cast<float>(description_.sensor.min_range_m) / description_.range_scale_m;
#pragma omp for schedule(static)
  for (int row = 0; row < rows_; ++row) {
    float* ranges = &state.raster[static_cast<std::size_t>(row) * columns_];
    take_image_row(of_h ? current.input : current.z, tile, row, ranges);
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
  const int last = description_.layers - 1;
#pragma omp parallel num_threads(threads_)
  fill_raster(state, last);
  remove_outliers(state, last);
}

void UnrolledNetwork::set_y(LayerState& layer) const {
  const TileSize tile = denoisers_.front()->tile();
  const bool of_h = description_.filtered == FilteredIterate::kH;
  const Tensor& filtered = of_h ? layer.denoiser.input : layer.denoiser.z;
  const bool zero = description_.rejected == RejectedPixel::kZero;
#pragma omp for schedule(static)
  for (int row = 0; row < layer.y.rows(); ++row) {
    for (int channel = 0; channel < tile.pixels(); ++channel) {
      std::copy_n(filtered.row(channel, row), layer.y.columns(), layer.y.row(channel, row));
    }
    // Few pixels are rejected: look for them eight at a time.
    const std::uint8_t* mask = layer.rejected.data() + row * tile.rows * columns_;
    for (int begin = 0; begin < tile.rows * columns_; begin += 8) {
      const int end = std::min(begin + 8, tile.rows * columns_);
      std::uint64_t any = 0;
      std::memcpy(&any, mask + begin, static_cast<std::size_t>(end - begin));
      if (any == 0) continue;
      for (int pixel = begin; pixel < end; ++pixel) {
        if (mask[pixel] == 0) continue;
        const int x = pixel % columns_;
        const int channel = pixel / columns_ * tile.columns + x % tile.columns;
        layer.y.row(channel, row)[x / tile.columns] =
            zero ? 0.0F : layer.denoiser.z.row(channel, row)[x / tile.columns];
      }
    }
  }
}

void UnrolledNetwork::forward(UnrolledState& state, std::optional<std::uint64_t> dropout_seed) {
  for (int layer = 0; layer < description_.layers; ++layer) {
    const std::uint64_t seed = dropout_seed.value_or(0) * 1000 + layer * 10;
    run_layer(state, layer, dropout_seed ? std::optional(seed) : std::nullopt);
    if (has_filter_after(layer)) remove_outliers(state, layer);
  }
}

// --- backward ------------------------------------------------------------------------------------

struct UnrolledNetwork::BackwardScratch {
  DenoiserState gradient;
  Tensor d_z;
  Tensor d_y;
  Tensor d_h;
  Tensor d_a;
};

/// Calls visit(channel, x, rejected) for every pixel of the tiles.
template <typename Visit>
static void for_each_pixel(TileSize tile, const Tensor& tiles,
                           const std::vector<std::uint8_t>& rejected, int row, const Visit& visit) {
  const int columns = tiles.columns() * tile.columns;
  for (int channel = 0; channel < tile.pixels(); ++channel) {
    const std::uint8_t* mask = rejected.data() +
                               (row * tile.rows + channel / tile.columns) * columns +
                               channel % tile.columns;
    for (int x = 0; x < tiles.columns(); ++x) visit(channel, x, mask[x * tile.columns] != 0);
  }
}

void UnrolledNetwork::backward_y(const LayerState& layer, const Tensor& d_y, Tensor& d_h,
                                 Tensor& d_z) const {
  const bool of_h = description_.filtered == FilteredIterate::kH;
  const bool zero = description_.rejected == RejectedPixel::kZero;
  for (int row = 0; row < d_y.rows(); ++row) {
    for_each_pixel(denoisers_.front()->tile(), d_y, layer.rejected, row,
                   [&](int channel, int x, bool rejected) {
                     const float gradient = d_y.row(channel, row)[x];
                     float& to_h = d_h.row(channel, row)[x];
                     float& to_z = d_z.row(channel, row)[x];
                     to_h = !rejected && of_h ? gradient : 0.0F;
                     if (rejected ? !zero : !of_h) to_z += gradient;
                   });
  }
}

void UnrolledNetwork::add_penalty_gradient(int layer, double d_penalty,
                                           std::span<float> d_parameters) const {
  if (description_.kind == NetworkKind::kSimpleDu) {
    // b = 1 / (2 alpha)
    d_parameters.back() += static_cast<float>(-d_penalty * 0.5 / (alpha_ * alpha_));
  } else {
    d_parameters[d_parameters.size() - description_.layers + layer] +=
        static_cast<float>(d_penalty * penalty_[layer]);
  }
}

void UnrolledNetwork::backward(const UnrolledState& state, std::span<const Tensor> d_z,
                               std::span<float> d_parameters) {
  if (static_cast<int>(state.slots.size()) != description_.layers) {
    throw Error(fmt::format("network: a state that kept {} of {} layers, expected all of them",
                            state.slots.size(), description_.layers));
  }
  if (d_z.empty() || static_cast<int>(d_z.size()) > description_.layers) {
    throw Error(fmt::format("network: gradients of {} layers, expected of 1 to {}", d_z.size(),
                            description_.layers));
  }
  const bool simple = description_.kind == NetworkKind::kSimpleDu;
  const Denoiser& any = *denoisers_.front();
  const int pixels = any.tile().pixels();
  const int memory = any.memory_channels();
  if (backward_ == nullptr) {
    backward_ = std::make_shared<BackwardScratch>(
        BackwardScratch{any.make_state(), state.z0, state.z0, state.z0, state.z0});
  }
  BackwardScratch& scratch = *backward_;
  DenoiserState& gradient = scratch.gradient;
  scratch.d_z.set_zero();
  scratch.d_y.set_zero();
  const int first_memory = gradient.output.channels() - memory;
  if (memory > 0) clear_channels(first_memory, gradient.output);
  for (int layer = description_.layers - 1; layer >= 0; --layer) {
    const LayerState& current = state.layer(layer);
    const bool last = layer + 1 == description_.layers;
    if (last || simple) {
      scratch.d_h.set_zero();
    } else {
      backward_y(current, scratch.d_y, scratch.d_h, scratch.d_z);
    }
    const int from_end = description_.layers - 1 - layer;
    if (from_end < static_cast<int>(d_z.size())) {
      add_tiles(d_z[d_z.size() - 1 - from_end], pixels, scratch.d_z);
    }
    gradient.z = scratch.d_z;
    const std::size_t begin = description_.shared_weights ? 0 : layer * denoiser_parameters_;
    denoiser(layer).backward(state.candidates, current.denoiser, gradient,
                             d_parameters.subspan(begin, denoiser_parameters_));
    add_tiles(gradient.input, pixels, scratch.d_h);
    const double d_penalty = data_consistency(layer).backward(
        state.l, previous_z(state, layer), previous_y(state, layer), scratch.d_h, scratch.d_a);
    add_penalty_gradient(layer, d_penalty, d_parameters);
    if (memory > 0) copy_channels(gradient.input, pixels, memory, gradient.output, first_memory);
    // A is the mean of Z and Y; Simple DU's Y is its Z.
    for (int channel = 0; channel < pixels; ++channel) {
      for (int row = 0; row < scratch.d_a.rows(); ++row) {
        const float* from = scratch.d_a.row(channel, row);
        float* to_z = scratch.d_z.row(channel, row);
        float* to_y = scratch.d_y.row(channel, row);
        for (int x = 0; x < scratch.d_a.columns(); ++x) {
          to_z[x] = simple ? from[x] : 0.5F * from[x];
          to_y[x] = simple ? 0.0F : 0.5F * from[x];
        }
      }
    }
  }
}

}  // namespace hqslam::nn
