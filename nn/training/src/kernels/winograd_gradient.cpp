#include <algorithm>
#include <array>

#include "kernels/winograd_convolution.h"

// The gradient of the weights.
namespace hqslam::nn::kernels {
namespace {

/// Adds G^T u G.
void add_filter_gradient(const std::array<float, 16>& u, float* d_filter) {
  std::array<std::array<float, 4>, 3> half{};
  for (int column = 0; column < 4; ++column) {
    const float sum = 0.5F * (u[4 + column] + u[8 + column]);
    half[0][column] = u[column] + sum;
    half[1][column] = 0.5F * (u[4 + column] - u[8 + column]);
    half[2][column] = sum + u[12 + column];
  }
  for (int row = 0; row < 3; ++row) {
    const float sum = 0.5F * (half[row][1] + half[row][2]);
    d_filter[3 * row] += half[row][0] + sum;
    d_filter[3 * row + 1] += 0.5F * (half[row][1] - half[row][2]);
    d_filter[3 * row + 2] += sum + half[row][3];
  }
}

}  // namespace

void WinogradConvolution::transform_gradient_run(const Tensor& d_output, int channel,
                                                 const Run& run, WinogradGradientRow row,
                                                 Scratch& scratch) const {
  const int end = run.vector + run.vectors;
  const bool beyond = end * kVectorColumns > columns_;  // where there are no results
  row.tiles = (run.vectors - (beyond ? 1 : 0)) * kVectorTiles;
  float* const edge[2] = {scratch.edge.data(), scratch.edge.data() + kEdgeColumns};
  for (int part = 0; part < 2; ++part) {
    const int y = 2 * run.tile_row + part;
    if (y >= rows_) break;
    const float* values = d_output.row(channel, y);
    row.d_output[part] = values + run.vector * kVectorColumns;
    if (beyond) {
      const int column = (end - 1) * kVectorColumns;
      std::fill_n(edge[part], kVectorColumns, 0.0F);
      std::copy(values + column, values + columns_, edge[part]);
    }
  }
  kernels_->winograd_gradient(row);
  if (!beyond) return;
  for (int part = 0; part < 2; ++part) {
    if (row.d_output[part] != nullptr) row.d_output[part] = edge[part];
  }
  row.transformed += row.tiles;
  row.tiles = kVectorTiles;
  kernels_->winograd_gradient(row);
}

void WinogradConvolution::transform_gradient(const Tensor& d_output, const Panel& panel,
                                             Scratch& scratch) const {
  const std::int64_t width = panel.shape.vectors * kVectorTiles;
  for (int channel = 0; channel < shape_.output_channels; ++channel) {
    for_each_run(panel, [&](const Run& run) {
      WinogradGradientRow row;
      row.transformed = scratch.products.data() + channel * width + run.tile;
      row.place_stride = panel.shape.output_place_stride;
      transform_gradient_run(d_output, channel, run, row, scratch);
    });
  }
}

void WinogradConvolution::correlate(const Panel& panel, Scratch& scratch) const {
  CorrelateRows rows;
  rows.narrow_channel_stride = panel.shape.vectors * kVectorTiles;
  rows.narrow_channels = shape_.output_channels;
  rows.tap_offset = panel.shape.channel_offset.data();
  rows.taps = shape_.input_channels;
  rows.rows = 1;
  rows.columns = (panel.last - panel.first) * kVectorTiles;
  const std::int64_t sums = shape_.input_channels * whole_blocks(shape_.output_channels);
  for (int place = 0; place < kPlaces; ++place) {
    rows.narrow = scratch.products.data() + place * panel.shape.output_place_stride;
    rows.wide = scratch.transformed.data() + place * panel.shape.input_place_stride;
    rows.gradient = scratch.gradient.data() + place * sums;
    kernels_->correlate(rows);
  }
}

void WinogradConvolution::add_weight_gradient(const Tensor& input, const Tensor& d_output,
                                              std::span<float> d_weights) const {
  Scratch& scratch = scratch_of_thread(gradient_panel_);
  const std::int64_t padded = whole_blocks(shape_.output_channels);
  const std::int64_t sums = shape_.input_channels * padded;
  scratch.gradient.assign(kPlaces * sums, 0.0F);
  const int vectors = tile_rows_ * row_vectors_;
  for (int first = 0; first < vectors; first += gradient_panel_.vectors) {
    const Panel panel{gradient_panel_, first, std::min(first + gradient_panel_.vectors, vectors)};
    transform_input(input, panel, scratch);
    transform_gradient(d_output, panel, scratch);
    correlate(panel, scratch);
  }
  for (int output = 0; output < shape_.output_channels; ++output) {
    for (int channel = 0; channel < shape_.input_channels; ++channel) {
      std::array<float, kPlaces> places;
      for (int place = 0; place < kPlaces; ++place) {
        places[place] = scratch.gradient[place * sums + channel * padded + output];
      }
      add_filter_gradient(places, &d_weights[(output * shape_.input_channels + channel) * 9]);
    }
  }
}

}  // namespace hqslam::nn::kernels
