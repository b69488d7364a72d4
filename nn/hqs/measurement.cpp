#include "measurement.h"

#include <omp.h>

#include <algorithm>
#include <cmath>

#include "hqslam/nn/interpolation.h"

namespace hqslam::nn {
namespace {

// What is recalled beyond these, or is no number, is not recalled.
constexpr float kFarthest_m = 1e4F;
constexpr float kLargestWeight = 1e4F;

}  // namespace

ScaledRanges::ScaledRanges(const NetworkDescription& d, TileSize tile, const Tensor& shape,
                           bool starts_at_zero)
    : measured_rows_(d.measured_rows),
      range_scale_m_(d.range_scale_m),
      tile_(tile),
      starts_at_zero_(starts_at_zero),
      scaled_(select_rows(d.sensor, d.measured_rows).rows(), shape.columns() * tile.columns),
      candidates_{shape, shape} {}

void ScaledRanges::take(const Observation& seen) {
  const RangeImage& measured_m = seen.measured;
#pragma omp master
  measured_m_ = &measured_m;
#pragma omp for schedule(static)
  for (int row = 0; row < scaled_.rows; ++row) {
    const float* from = &measured_m.range_m[measured_m.index(row, 0)];
    float* to = &scaled_.range_m[scaled_.index(row, 0)];
    for (int x = 0; x < scaled_.columns; ++x) to[x] = from[x] / range_scale_m_;
  }
}

void ScaledRanges::start_row(int row, float* image_rows, Tensor& z0) {
  const RangeImage& measured_m = *measured_m_;
  for (int i = 0; i < tile_.rows; ++i) {
    const int image_row = row * tile_.rows + i;
    const RowsBetween between = rows_between(image_row, measured_rows_, scaled_.rows);
    const float* above = &scaled_.range_m[scaled_.index(between.above, 0)];
    const float* below = &scaled_.range_m[scaled_.index(between.below, 0)];
    put_image_row(above, tile_, image_row, candidates_.above);
    put_image_row(below, tile_, image_row, candidates_.below);
    const float* first = below;
    float* own = image_rows + static_cast<std::size_t>(i) * scaled_.columns;
    if (starts_at_zero_) {
      std::fill_n(own, scaled_.columns, 0.0F);
      first = own;
    } else if (between.above != between.below) {
      interpolate_row(&measured_m.range_m[measured_m.index(between.above, 0)],
                      &measured_m.range_m[measured_m.index(between.below, 0)], between.part_down,
                      Interpolation::kLinear, scaled_.columns, own);
      for (int x = 0; x < scaled_.columns; ++x) own[x] /= range_scale_m_;
      first = own;
    }
    put_image_row(first, tile_, image_row, z0);
  }
}

/// In a measured row the nearest measured range is its own.
const float* ScaledRanges::l_row(int channel, int row) const {
  return measured(tile_, measured_rows_, channel, row) ? candidates_.below.row(channel, row)
                                                       : nullptr;
}

RangeImage ScaledRanges::in_metres(const Tensor& tiles) const {
  RangeImage image(tiles.rows() * tile_.rows, tiles.columns() * tile_.columns);
  from_tiles(tiles, tile_, image.range_m.data());
  for (float& range_m : image.range_m) range_m *= range_scale_m_;
  return image;
}

LogRanges::LogRanges(const NetworkDescription& d, TileSize tile, int columns, bool recalls,
                     const Engine& engine)
    : measured_rows_(d.measured_rows),
      tile_(tile),
      kernels_(kernels::row_kernels(engine.instruction_set)),
      log_(tile.columns, d.sensor.rows() / tile.rows, columns / tile.columns,
           ColumnPadding::kCircular),
      inverse_(log_),
      valid_(log_),
      scratch_(engine.threads,
               std::vector<float>(3 * static_cast<std::size_t>(log_.padded_columns()))) {
  for (int channel = 0; channel < tile_.pixels(); ++channel) {
    const int row = channel / tile_.columns;
    if (row == measured_rows_.offset) continue;
    computed_.push_back({channel, channel % tile_.columns, row < measured_rows_.offset});
  }
  for (int row = 0; row < d.sensor.rows(); ++row) {
    const RowsBetween between = rows_between(row, measured_rows_, d.sensor.beam_elevation_rad);
    weight_above_.push_back(1.0F - between.part_down);
  }
  if (recalls) {
    recalled_log_ = recalled_share_ =
        recalled_step_ = {tile.pixels(), log_.rows(), log_.columns(), ColumnPadding::kCircular};
  }
}

int LogRanges::row_above(const ComputedPixel& pixel, int row) const {
  return std::max(pixel.above ? row - 1 : row, 0);
}

int LogRanges::row_below(const ComputedPixel& pixel, int row) const {
  return std::min(pixel.above ? row : row + 1, log_.rows() - 1);
}

void LogRanges::take(const Observation& seen) {
  const RangeImage& measured_m = seen.measured;
#pragma omp master
  measured_m_ = &measured_m;
#pragma omp for schedule(static)
  for (int phase = 0; phase < tile_.columns; ++phase) {
    float* ranges = scratch_[omp_get_thread_num()].data();
    float* log_above = ranges + log_.padded_columns();
    float* inverse_above = log_above + log_.padded_columns();
    std::fill_n(log_above, log_.columns(), kTypicalLogRange);
    std::fill_n(inverse_above, log_.columns(), 1.0F / kTypicalRange_m);
    for (int row = 0; row < log_.rows(); ++row) {
      const float* from = &measured_m.range_m[measured_m.index(row, phase)];
      for (int x = 0; x < log_.columns(); ++x) ranges[x] = from[x * tile_.columns];
      const bool top = row == 0;
      kernels_.fill_measured({.range_m = ranges,
                              .log_range_above = top ? log_above : log_.row(phase, row - 1),
                              .inverse_above = top ? inverse_above : inverse_.row(phase, row - 1),
                              .log_range = log_.row(phase, row),
                              .inverse = inverse_.row(phase, row),
                              .valid = valid_.row(phase, row),
                              .columns = log_.columns()});
    }
  }
  if (recalled_log_.channels() == 0) return;
#pragma omp for schedule(static)
  for (int row = 0; row < log_.rows(); ++row) take_recalled(seen.recalled, row);
}

/// M and W of one row of tiles, of its measured pixels too: there M shows how well the poses fit.
void LogRanges::take_recalled(const RecalledImage* recalled, int row) {
  const bool nothing = recalled == nullptr || recalled->is_empty();
  for (int channel = 0; channel < tile_.pixels(); ++channel) {
    float* log = recalled_log_.row(channel, row);
    float* share = recalled_share_.row(channel, row);
    if (nothing) {
      std::fill_n(share, log_.columns(), 0.0F);
      continue;
    }
    const std::size_t first =
        recalled->image.index(row * tile_.rows + channel / tile_.columns, channel % tile_.columns);
    for (int x = 0; x < log_.columns(); ++x) {
      const std::size_t from = first + static_cast<std::size_t>(x) * tile_.columns;
      const float range_m = recalled->image.range_m[from];
      const bool there = range_m > 0.0F && range_m < kFarthest_m && recalled->weight[from] > 0.0F;
      const float weight = there ? std::min(recalled->weight[from], kLargestWeight) : 0.0F;
      log[x] = there ? std::log(range_m) : 0.0F;
      share[x] = weight / (weight + 1.0F);
    }
  }
}

/// M minus what is there without it.
void LogRanges::put_recalled_step(int channel, int row, const float* start) {
  const float* m = recalled_log_.row(channel, row);
  const float* share = recalled_share_.row(channel, row);
  float* step = recalled_step_.row(channel, row);
  for (int x = 0; x < log_.columns(); ++x) step[x] = share[x] > 0.0F ? m[x] - start[x] : 0.0F;
}

void LogRanges::start_row(int row, float* /*image_rows*/, Tensor& z0) {
  for (const ComputedPixel& pixel : computed_) {
    const float weight_above = weight_above_[row * tile_.rows + pixel.channel / tile_.columns];
    kernels_.interpolate({.inverse_above = inverse_.row(pixel.phase, row_above(pixel, row)),
                          .inverse_below = inverse_.row(pixel.phase, row_below(pixel, row)),
                          .weight_above = weight_above,
                          .weight_below = 1.0F - weight_above,
                          .log_range = z0.row(pixel.channel, row),
                          .columns = log_.columns()});
    if (recalled_log_.channels() > 0) {
      put_recalled_step(pixel.channel, row, z0.row(pixel.channel, row));
    }
  }
  for (int phase = 0; phase < tile_.columns && recalled_log_.channels() > 0; ++phase) {
    put_recalled_step(measured_rows_.offset * tile_.columns + phase, row, log_.row(phase, row));
  }
}

const float* LogRanges::l_row(int channel, int row) const {
  const bool is_measured = channel / tile_.columns == measured_rows_.offset;
  return is_measured ? log_.row(channel % tile_.columns, row) : nullptr;
}

RecalledRow LogRanges::recalled_row(int channel, int row) const {
  if (recalled_log_.channels() == 0 || channel / tile_.columns == measured_rows_.offset) return {};
  return {recalled_log_.row(channel, row), recalled_share_.row(channel, row)};
}

RangeImage LogRanges::in_metres(const Tensor& tiles) const {
  RangeImage image(tiles.rows() * tile_.rows, tiles.columns() * tile_.columns);
  from_tiles(tiles, tile_, image.range_m.data());
  for (float& range_m : image.range_m) range_m = std::exp(range_m);
  for (int row = 0; row < log_.rows(); ++row) {
    for (int column = 0; column < image.columns; ++column) {
      const bool valid = valid_.at(column % tile_.columns, row, column / tile_.columns) > 0.0F;
      image.at(row * tile_.rows + measured_rows_.offset, column) =
          valid ? measured_m_->at(row, column) : 0.0F;
    }
  }
  return image;
}

}  // namespace hqslam::nn
