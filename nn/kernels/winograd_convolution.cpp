#include "winograd_convolution.h"

#include <array>

#include "hqslam/core/error.h"

namespace hqslam::nn::kernels {
namespace {

/// A value for each output channel of a block.
using Block = std::array<float, kOutputBlock>;

/// G x, of every channel
void transform_filter(const Block* x, std::ptrdiff_t x_stride, Block* y, std::ptrdiff_t y_stride) {
  for (int o = 0; o < kOutputBlock; ++o) {
    const float sum = 0.5F * (x[0][o] + x[2 * x_stride][o]);
    const float middle = 0.5F * x[x_stride][o];
    y[0][o] = x[0][o];
    y[y_stride][o] = sum + middle;
    y[2 * y_stride][o] = sum - middle;
    y[3 * y_stride][o] = x[2 * x_stride][o];
  }
}

/// G g G^T
std::array<Block, 16> transformed_filters(const std::array<Block, 9>& g) {
  std::array<Block, 12> half;
  for (int column = 0; column < 3; ++column) transform_filter(&g[column], 3, &half[column], 3);
  std::array<Block, 16> whole;
  for (std::size_t row = 0; row < 4; ++row) transform_filter(&half[3 * row], 1, &whole[4 * row], 1);
  return whole;
}

bool is_3x3_without_stride(const ConvolutionShape& shape) {
  return shape.kernel_rows == 3 && shape.kernel_columns == 3 && shape.stride == 1 &&
         shape.column_stride() == 1 && shape.padding_rows == 1 && shape.padding_columns == 1;
}

}  // namespace

bool WinogradConvolution::suits(const ConvolutionShape& shape, const Tensor& input) {
  constexpr int kFewestChannels = 16;
  return is_3x3_without_stride(shape) && shape.input_channels >= kFewestChannels &&
         shape.output_channels >= kFewestChannels && input.columns() >= kVectorColumns;
}

WinogradConvolution::WinogradConvolution(const ConvolutionShape& shape, const Tensor& input,
                                         InstructionSet instruction_set, int threads)
    : shape_(shape),
      rows_(input.rows()),
      columns_(input.columns()),
      tile_rows_((rows_ + 1) / 2),
      row_vectors_((columns_ + kVectorColumns - 1) / kVectorColumns),
      kernels_(&row_kernels(instruction_set)) {
  validate(shape_);
  if (!is_3x3_without_stride(shape)) {
    throw Error(
        "convolution: kernel {} x {}, strides {} and {}, padding {} and {}; expected 3 x 3, 1, 1",
        shape.kernel_rows, shape.kernel_columns, shape.stride, shape.column_stride(),
        shape.padding_rows, shape.padding_columns);
  }
  // Enough vectors that the transformed weights are not fetched too often, and the transformed
  // images stay in the second-level cache.
  constexpr int kMostVectors = 8;
  rows_per_task_ = std::clamp(kMostVectors / row_vectors_, 1, (tile_rows_ + threads - 1) / threads);
  forward_panel_ = panel_shape(std::min(kMostVectors, row_vectors_ * rows_per_task_));
  // The gradient adds the lanes of its sums once for every panel.
  constexpr int kCachedFloats = 1 << 18;
  const int channels = shape.input_channels + shape.output_channels;
  const int cached = kCachedFloats / (kPlaces * kVectorTiles * channels);
  gradient_panel_ = panel_shape(std::min(std::max(4, cached), row_vectors_ * tile_rows_));
}

WinogradConvolution::PanelShape WinogradConvolution::panel_shape(int vectors) const {
  const std::int64_t width = vectors * kVectorTiles;
  // A cache line more: places would otherwise be a multiple of 4 KB apart, all in one set.
  PanelShape panel{
      .vectors = vectors,
      .input_place_stride = shape_.input_channels * width + kVectorTiles,
      .output_place_stride = whole_blocks(shape_.output_channels) * width + kVectorTiles};
  for (int channel = 0; channel < shape_.input_channels; ++channel) {
    panel.channel_offset.push_back(channel * width);
  }
  return panel;
}

void WinogradConvolution::set_weights(std::span<const float> weights, bool adjoint) {
  if (static_cast<std::int64_t>(weights.size()) != shape_.weights()) {
    throw Error("convolution: {} weights, expected {}", weights.size(), shape_.weights());
  }
  const std::int64_t inputs = shape_.input_channels;
  const std::int64_t outputs = shape_.output_channels;
  const std::int64_t padded = whole_blocks(shape_.output_channels);
  weights_.resize(kPlaces * padded * inputs);
  std::array<Block, 9> filters{};
  for (std::int64_t first = 0; first < outputs; first += kOutputBlock) {
    const auto channels = static_cast<int>(std::min<std::int64_t>(kOutputBlock, outputs - first));
    for (std::int64_t input = 0; input < inputs; ++input) {
      for (int o = 0; o < kOutputBlock; ++o) {
        const std::int64_t filter =
            adjoint ? input * outputs + first + o : (first + o) * inputs + input;
        for (int tap = 0; tap < 9; ++tap) {  // the adjoint's are turned by 180 degrees
          filters[tap][o] = o < channels ? weights[filter * 9 + (adjoint ? 8 - tap : tap)] : 0.0F;
        }
      }
      const std::array<Block, kPlaces> transformed = transformed_filters(filters);
      for (std::size_t place = 0; place < kPlaces; ++place) {
        std::ranges::copy(transformed[place],
                          &weights_[(place * padded + first) * inputs + input * kOutputBlock]);
      }
    }
  }
}

/// One for all layers: what one leaves in the cache is overwritten by the next.
WinogradConvolution::Scratch& WinogradConvolution::scratch_of_thread(
    const PanelShape& shape) const {
  thread_local Scratch scratch;
  const auto grow = [](std::size_t size, CacheLineFloats& values) {
    if (values.size() < size) values.resize(size);
  };
  grow(kPlaces * shape.input_place_stride, scratch.transformed);
  grow(kPlaces * shape.output_place_stride, scratch.products);
  grow(4 * kEdgeColumns, scratch.edge);
  return scratch;
}

void WinogradConvolution::transform_run(const Tensor& input, int channel, const Run& run,
                                        WinogradInputRow row, Scratch& scratch) const {
  const int end = run.vector + run.vectors;
  // The last vector of tiles may end one column behind the border.
  const bool beyond = end * kVectorColumns == input.padded_columns() + kVectorTiles;
  row.tiles = (run.vectors - (beyond ? 1 : 0)) * kVectorTiles;
  for (int i = 0; i < 4; ++i) {
    // With an odd number of rows there is one row too few for a second row of results: any will do.
    const float* values = input.row(channel, std::min(2 * run.tile_row + i - 1, rows_)) - 1;
    row.input[i] = values + run.vector * kVectorColumns;
    if (beyond) {
      std::copy_n(values + (end - 1) * kVectorColumns, kEdgeColumns - 1,
                  scratch.edge.data() + i * kEdgeColumns);
    }
  }
  kernels_->winograd_input(row);
  if (!beyond) return;
  for (int i = 0; i < 4; ++i) row.input[i] = scratch.edge.data() + i * kEdgeColumns;
  row.transformed += row.tiles;
  row.tiles = kVectorTiles;
  kernels_->winograd_input(row);
}

void WinogradConvolution::transform_input(const Tensor& input, const Panel& panel,
                                          Scratch& scratch) const {
  for (int channel = 0; channel < shape_.input_channels; ++channel) {
    for_each_run(panel, [&](const Run& run) {
      WinogradInputRow row;
      row.transformed = scratch.transformed.data() + panel.shape.channel_offset[channel] + run.tile;
      row.place_stride = panel.shape.input_place_stride;
      transform_run(input, channel, run, row, scratch);
    });
  }
}

void WinogradConvolution::multiply(const Panel& panel, Scratch& scratch) const {
  const std::int64_t weights_of_place =
      whole_blocks(shape_.output_channels) * shape_.input_channels;
  AccumulateRow row;
  row.tap_offset = panel.shape.channel_offset.data();
  row.taps = shape_.input_channels;
  row.output_channels = shape_.output_channels;
  row.output_channel_stride = panel.shape.vectors * kVectorTiles;
  row.end = (panel.last - panel.first) * kVectorTiles;
  for (int place = 0; place < kPlaces; ++place) {
    row.input = scratch.transformed.data() + place * panel.shape.input_place_stride;
    row.weights = weights_.data() + place * weights_of_place;
    row.output = scratch.products.data() + place * panel.shape.output_place_stride;
    kernels_->accumulate(row);
  }
}

void WinogradConvolution::transform_output(const float* bias, const LayerEnd& end,
                                           const Panel& panel, const Scratch& scratch,
                                           Tensor& output) const {
  const std::int64_t width = panel.shape.vectors * kVectorTiles;
  for (int channel = 0; channel < shape_.output_channels; ++channel) {
    for_each_run(panel, [&](const Run& run) {
      WinogradOutputRow row;
      row.products = scratch.products.data() + channel * width + run.tile;
      row.place_stride = panel.shape.output_place_stride;
      row.tiles = run.vectors * kVectorTiles;
      row.bias = bias == nullptr ? 0.0F : bias[channel];
      row.negative_slope = end.negative_slope;
      const int column = run.vector * kVectorColumns;
      for (int part = 0; part < 2; ++part) {
        const int y = 2 * run.tile_row + part;
        if (y >= rows_) break;
        row.output[part] = output.row(channel, y) + column;
        if (end.skip != nullptr) row.skip[part] = end.skip->row(channel, y) + column;
        if (end.activated != nullptr) {
          row.activated[part] = end.activated->row(channel, y) + column;
        }
      }
      kernels_->winograd_output(row);
    });
  }
}

void WinogradConvolution::forward(const Tensor& input, const float* bias, const LayerEnd& end,
                                  Tensor& output) const {
  const int tasks = (tile_rows_ + rows_per_task_ - 1) / rows_per_task_;
  // Not all threads of a team may come at the same time (find_outliers_of_h in hqs_loop.cpp).
#pragma omp for schedule(dynamic)
  for (int task = 0; task < tasks; ++task) {
    Scratch& scratch = scratch_of_thread(forward_panel_);
    const int first_row = task * rows_per_task_;
    const int last_row = std::min(tile_rows_, first_row + rows_per_task_);
    const int last = last_row * row_vectors_;
    for (int first = first_row * row_vectors_; first < last; first += forward_panel_.vectors) {
      const Panel panel{forward_panel_, first, std::min(first + forward_panel_.vectors, last)};
      transform_input(input, panel, scratch);
      multiply(panel, scratch);
      transform_output(bias, end, panel, scratch, output);
    }
    for (int y = 2 * first_row; y < std::min(rows_, 2 * last_row); ++y) {
      for (int channel = 0; channel < shape_.output_channels; ++channel) {
        output.fill_border(channel, y);
      }
    }
  }
}

}  // namespace hqslam::nn::kernels
