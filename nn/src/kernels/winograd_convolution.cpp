#include "winograd_convolution.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "hqslam/core/error.h"

namespace hqslam::nn::kernels {
namespace {

constexpr int kPlaces = 16;
constexpr int kVectorTiles = 16;
constexpr int kVectorColumns = 2 * kVectorTiles;
/// A vector of tiles reads its own columns and one more on either side.
constexpr int kEdgeColumns = kVectorColumns + 2;

int blocks_of(int channels) { return (channels + kOutputBlock - 1) / kOutputBlock; }

/// G g G^T
std::array<float, kPlaces> transformed_filter(const float* g) {
  std::array<std::array<float, 3>, 4> half{};
  for (int column = 0; column < 3; ++column) {
    const float sum = 0.5F * (g[column] + g[6 + column]);
    const float middle = 0.5F * g[3 + column];
    half[0][column] = g[column];
    half[1][column] = sum + middle;
    half[2][column] = sum - middle;
    half[3][column] = g[6 + column];
  }
  std::array<float, kPlaces> whole{};
  for (int row = 0; row < 4; ++row) {
    const float sum = 0.5F * (half[row][0] + half[row][2]);
    const float middle = 0.5F * half[row][1];
    whole[4 * row] = half[row][0];
    whole[4 * row + 1] = sum + middle;
    whole[4 * row + 2] = sum - middle;
    whole[4 * row + 3] = half[row][2];
  }
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
    throw Error(fmt::format(
        "convolution: kernel {} x {}, strides {} and {}, padding {} and {}; expected 3 x 3, 1, 1",
        shape.kernel_rows, shape.kernel_columns, shape.stride, shape.column_stride(),
        shape.padding_rows, shape.padding_columns));
  }
  // So many that the transformed weights are not fetched too often, and the transformed images stay
  // in the second-level cache.
  constexpr int kMostPanelVectors = 8;
  rows_per_task_ =
      std::clamp(kMostPanelVectors / row_vectors_, 1, (tile_rows_ + threads - 1) / threads);
  panel_vectors_ = std::min(kMostPanelVectors, row_vectors_ * rows_per_task_);
  const std::int64_t width = panel_vectors_ * kVectorTiles;
  // A cache line more: places would otherwise lie a multiple of 4 KB apart, all in one set.
  input_place_stride_ = shape.input_channels * width + kVectorTiles;
  output_place_stride_ = blocks_of(shape.output_channels) * kOutputBlock * width + kVectorTiles;
  for (int channel = 0; channel < shape.input_channels; ++channel) {
    channel_offset_.push_back(channel * width);
  }
}

void WinogradConvolution::set_weights(std::span<const float> weights) {
  if (static_cast<std::int64_t>(weights.size()) != shape_.weights()) {
    throw Error(
        fmt::format("convolution: {} weights, expected {}", weights.size(), shape_.weights()));
  }
  const int inputs = shape_.input_channels;
  const std::size_t blocks = blocks_of(shape_.output_channels);
  weights_.assign(kPlaces * blocks * inputs * kOutputBlock, 0.0F);
  for (int output = 0; output < shape_.output_channels; ++output) {
    const std::size_t block = output / kOutputBlock;
    for (int input = 0; input < inputs; ++input) {
      const std::array<float, kPlaces> filter =
          transformed_filter(&weights[(static_cast<std::size_t>(output) * inputs + input) * 9]);
      for (std::size_t place = 0; place < kPlaces; ++place) {
        weights_[((place * blocks + block) * inputs + input) * kOutputBlock +
                 output % kOutputBlock] = filter[place];
      }
    }
  }
}

/// One for all layers: what one leaves in the cache is overwritten by the next.
WinogradConvolution::Scratch& WinogradConvolution::scratch_of_thread() const {
  thread_local Scratch scratch;
  const auto grow = [](std::size_t size, CacheLineFloats& values) {
    if (values.size() < size) values.resize(size);
  };
  grow(kPlaces * input_place_stride_, scratch.transformed);
  grow(kPlaces * output_place_stride_, scratch.products);
  grow(4 * kEdgeColumns, scratch.edge);
  return scratch;
}

void WinogradConvolution::transform_run(const Tensor& input, int channel, int tile_row, int vector,
                                        int vectors, float* transformed, Scratch& scratch) const {
  WinogradInputRow row;
  row.transformed = transformed;
  row.place_stride = input_place_stride_;
  // The last vector of tiles may end one column behind the border.
  const bool beyond = (vector + vectors) * kVectorColumns == input.padded_columns() + kVectorTiles;
  row.tiles = (vectors - (beyond ? 1 : 0)) * kVectorTiles;
  const int last = vector + vectors - 1;
  for (int i = 0; i < 4; ++i) {
    // With an odd number of rows there is one row too few for a second row of results: any will do.
    const float* values = input.row(channel, std::min(2 * tile_row + i - 1, rows_)) - 1;
    row.input[i] = values + vector * kVectorColumns;
    if (beyond) {
      std::copy_n(values + last * kVectorColumns, kEdgeColumns - 1,
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

void WinogradConvolution::transform_input(const Tensor& input, Panel panel,
                                          Scratch& scratch) const {
  for (int channel = 0; channel < shape_.input_channels; ++channel) {
    float* transformed = scratch.transformed.data() + channel_offset_[channel];
    for (int first = panel.first; first < panel.last;) {
      const int tile_row = first / row_vectors_;
      const int last = std::min(panel.last, (tile_row + 1) * row_vectors_);
      transform_run(input, channel, tile_row, first % row_vectors_, last - first,
                    transformed + (first - panel.first) * kVectorTiles, scratch);
      first = last;
    }
  }
}

void WinogradConvolution::multiply(Panel panel, Scratch& scratch) const {
  const std::int64_t weights_of_place =
      static_cast<std::int64_t>(blocks_of(shape_.output_channels)) * kOutputBlock *
      shape_.input_channels;
  AccumulateRow row;
  row.tap_offset = channel_offset_.data();
  row.taps = shape_.input_channels;
  row.output_channels = shape_.output_channels;
  row.output_channel_stride = panel_vectors_ * kVectorTiles;
  row.end = (panel.last - panel.first) * kVectorTiles;
  for (int place = 0; place < kPlaces; ++place) {
    row.input = scratch.transformed.data() + place * input_place_stride_;
    row.weights = weights_.data() + place * weights_of_place;
    row.output = scratch.products.data() + place * output_place_stride_;
    kernels_->accumulate(row);
  }
}

void WinogradConvolution::transform_output(const StridedConvolution::Epilogue& epilogue,
                                           Panel panel, const Scratch& scratch,
                                           Tensor& output) const {
  for (int channel = 0; channel < shape_.output_channels; ++channel) {
    const float* products = scratch.products.data() +
                            static_cast<std::int64_t>(channel) * panel_vectors_ * kVectorTiles;
    for (int first = panel.first; first < panel.last;) {
      const int tile_row = first / row_vectors_;
      const int last = std::min(panel.last, (tile_row + 1) * row_vectors_);
      WinogradOutputRow row;
      row.products = products + (first - panel.first) * kVectorTiles;
      row.place_stride = output_place_stride_;
      row.tiles = (last - first) * kVectorTiles;
      row.bias = epilogue.bias == nullptr ? 0.0F : epilogue.bias[channel];
      row.negative_slope = epilogue.negative_slope;
      const int column = first % row_vectors_ * kVectorColumns;
      for (int part = 0; part < 2; ++part) {
        const int y = 2 * tile_row + part;
        if (y >= rows_) break;
        row.output[part] = output.row(channel, y) + column;
        if (epilogue.skip != nullptr) row.skip[part] = epilogue.skip->row(channel, y) + column;
        if (epilogue.activated != nullptr) {
          row.activated[part] = epilogue.activated->row(channel, y) + column;
        }
      }
      kernels_->winograd_output(row);
      first = last;
    }
  }
}

void WinogradConvolution::forward(const Tensor& input, const StridedConvolution::Epilogue& epilogue,
                                  Tensor& output) const {
  const int tasks = (tile_rows_ + rows_per_task_ - 1) / rows_per_task_;
#pragma omp for schedule(static)
  for (int task = 0; task < tasks; ++task) {
    Scratch& scratch = scratch_of_thread();
    const int first_row = task * rows_per_task_;
    const int last_row = std::min(tile_rows_, first_row + rows_per_task_);
    for (int first = first_row * row_vectors_; first < last_row * row_vectors_;
         first += panel_vectors_) {
      const Panel panel{first, std::min(first + panel_vectors_, last_row * row_vectors_)};
      transform_input(input, panel, scratch);
      multiply(panel, scratch);
      transform_output(epilogue, panel, scratch, output);
    }
    for (int y = 2 * first_row; y < std::min(rows_, 2 * last_row); ++y) {
      for (int channel = 0; channel < shape_.output_channels; ++channel) {
        output.fill_border(channel, y);
      }
    }
  }
}

}  // namespace hqslam::nn::kernels
