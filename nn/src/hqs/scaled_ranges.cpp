#include <algorithm>

#include "hqslam/nn/interpolation.h"
#include "measurement.h"

namespace hqslam::nn {

ScaledRanges::ScaledRanges(const NetworkDescription& d, TileSize tile, const Tensor& shape,
                           bool starts_at_zero)
    : measured_rows_(d.measured_rows),
      range_scale_m_(d.range_scale_m),
      tile_(tile),
      starts_at_zero_(starts_at_zero),
      scaled_(select_rows(d.sensor, d.measured_rows).rows(), shape.columns() * tile.columns),
      candidates_{shape, shape} {}

void ScaledRanges::take(const RangeImage& measured_m) {
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

void ScaledRanges::put_truth(const RangeImage& truth_m, Tensor& tiles) const {
  RangeImage scaled = truth_m;
  for (float& range : scaled.range_m) range /= range_scale_m_;
  to_tiles(scaled.range_m.data(), tile_, tiles);
}

}  // namespace hqslam::nn
