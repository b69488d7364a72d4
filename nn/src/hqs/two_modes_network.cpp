#include "two_modes_network.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "../kernels/two_modes.h"
#include "../parameters.h"
#include "hqslam/core/error.h"
#include "hqslam/nn/interpolation.h"

namespace hqslam::nn {
namespace {

constexpr float kTypicalRange_m = 20.0F;
const float kTypicalLogRange = std::log(kTypicalRange_m);

}  // namespace

TwoModesNetwork::TwoModesNetwork(const TwoModesShape& shape, const NetworkDescription& description,
                                 int columns, InstructionSet instruction_set, int threads)
    : description_(description),
      shape_(shape),
      tile_(shape.tile),
      rows_(description.sensor.rows() / tile_.rows),
      columns_(columns / tile_.columns),
      threads_(threads),
      instruction_set_(instruction_set),
      measured_log_(tile_.columns, rows_, columns_, ColumnPadding::kCircular),
      measured_inverse_(measured_log_),
      measured_valid_(measured_log_) {
  const int measured_row = description_.measured_rows.offset;
  for (int channel = 0; channel < tile_.pixels(); ++channel) {
    const int row = channel / tile_.columns;
    if (row == measured_row) continue;
    computed_.push_back({channel, channel % tile_.columns, row < measured_row});
  }
  for (int row = 0; row < description_.sensor.rows(); ++row) {
    const RowsBetween between =
        rows_between(row, description_.measured_rows, description_.sensor.beam_elevation_rad);
    weight_above_.push_back(1.0F - between.part_down);
  }
  for (int layer = 0; layer < static_cast<int>(shape.layers.size()); ++layer) {
    ConvolutionGraph graph =
        two_modes_graph(shape, layer, rows_, columns_, instruction_set, threads);
    std::vector<Tensor> values = graph.make_values();
    const auto tiles = [&](int channels) {
      return Tensor(channels, rows_, columns_, ColumnPadding::kCircular);
    };
    const auto computed = static_cast<int>(computed_.size());
    const std::int64_t parameters = elements(graph.parameter_shapes());
    layers_.push_back({std::move(graph),
                       std::move(values),
                       {},
                       {},
                       tiles(tile_.pixels()),
                       tiles(computed),
                       tiles(computed),
                       parameters});
  }
  // A head's row, then ranges and confidences of a row of tiles.
  const auto row_floats = static_cast<std::size_t>(measured_log_.padded_columns());
  const std::size_t channels = two_modes_outputs(shape, 0) + shape.memory + 2 * computed_.size();
  scratch_.assign(threads, std::vector<float>(channels * row_floats));
  const int image_columns = columns_ * tile_.columns;
  lifted_.image = RangeImage(description_.sensor.rows(), image_columns);
  lifted_.confidence.assign(lifted_.image.range_m.size(), 0.0F);
}

std::int64_t TwoModesNetwork::multiply_adds() const {
  std::int64_t sum = 0;
  for (const Layer& layer : layers_) sum += layer.graph.multiply_adds();
  return sum;
}

void TwoModesNetwork::set_parameters(std::span<const float> parameters) {
  std::int64_t expected = 0;
  for (const Layer& layer : layers_) expected += layer.parameters;
  if (static_cast<std::int64_t>(parameters.size()) != expected) {
    throw Error(fmt::format("network: {} parameters, expected {}", parameters.size(), expected));
  }
  for (Layer& layer : layers_) layer.graph.set_parameters(take(parameters, layer.parameters));
}

void TwoModesNetwork::check(const RangeImage& measured) const {
  check_measured_rows(measured, description_.measured_rows, description_.sensor.rows());
  if (measured.columns != columns_ * tile_.columns) {
    throw Error(fmt::format("network: a scan of {} x {}, expected {} columns", measured.rows,
                            measured.columns, columns_ * tile_.columns));
  }
}

int TwoModesNetwork::measured_row_above(const ComputedPixel& pixel, int row) const {
  return std::max(pixel.above ? row - 1 : row, 0);
}

int TwoModesNetwork::measured_row_below(const ComputedPixel& pixel, int row) const {
  return std::min(pixel.above ? row : row + 1, rows_ - 1);
}

/// Cuts the measured rows into the columns of the tiles and fills what is empty from above.
void TwoModesNetwork::take_measured(const RangeImage& measured) {
  const kernels::RowKernels& kernels = kernels::row_kernels(instruction_set_);
#pragma omp for schedule(static)
  for (int phase = 0; phase < tile_.columns; ++phase) {
    float* ranges = scratch_[omp_get_thread_num()].data();
    float* log_above = ranges + measured_log_.padded_columns();
    float* inverse_above = log_above + measured_log_.padded_columns();
    std::fill_n(log_above, columns_, kTypicalLogRange);
    std::fill_n(inverse_above, columns_, 1.0F / kTypicalRange_m);
    for (int row = 0; row < rows_; ++row) {
      const float* from = &measured.range_m[measured.index(row, phase)];
      for (int x = 0; x < columns_; ++x) ranges[x] = from[x * tile_.columns];
      const bool top = row == 0;
      kernels.fill_measured(
          {.range_m = ranges,
           .log_range_above = top ? log_above : measured_log_.row(phase, row - 1),
           .inverse_above = top ? inverse_above : measured_inverse_.row(phase, row - 1),
           .log_range = measured_log_.row(phase, row),
           .inverse = measured_inverse_.row(phase, row),
           .valid = measured_valid_.row(phase, row),
           .columns = columns_});
    }
  }
}

/// A row of the first H: what was measured, and the start between it.
void TwoModesNetwork::start_row(int row) {
  const kernels::RowKernels& kernels = kernels::row_kernels(instruction_set_);
  Tensor& h = layers_.front().h;
  for (int phase = 0; phase < tile_.columns; ++phase) {
    const int channel = description_.measured_rows.offset * tile_.columns + phase;
    std::copy_n(measured_log_.row(phase, row), columns_, h.row(channel, row));
  }
  for (const ComputedPixel& pixel : computed_) {
    const float weight_above = weight_above_[row * tile_.rows + pixel.channel / tile_.columns];
    kernels.interpolate(
        {.inverse_above = measured_inverse_.row(pixel.phase, measured_row_above(pixel, row)),
         .inverse_below = measured_inverse_.row(pixel.phase, measured_row_below(pixel, row)),
         .weight_above = weight_above,
         .weight_below = 1.0F - weight_above,
         .log_range = h.row(pixel.channel, row),
         .columns = columns_});
  }
}

/// Everything that the convolutions see but for the memory, which the layer before has put there.
void TwoModesNetwork::make_input_row(int layer, int row) {
  Layer& self = layers_[layer];
  Tensor& input = self.values.front();
  const auto put = [&](int channel, auto value) {
    float* to = input.row(channel, row);
#pragma omp simd
    for (int x = 0; x < columns_; ++x) to[x] = value(x);
    input.fill_border(channel, row);
  };
  int channel = 0;
  for (; channel < tile_.pixels(); ++channel) {
    const float* h = self.h.row(channel, row);
    put(channel, [&](int x) { return 0.5F * (h[x] - kTypicalLogRange); });
  }
  for (int phase = 0; phase < tile_.columns; ++phase) {
    const float* valid = measured_valid_.row(phase, row);
    put(channel++, [&](int x) { return valid[x] - 0.5F; });
  }
  for (int phase = 0; phase < tile_.columns; ++phase) {
    const float* above = measured_log_.row(phase, std::max(row - 1, 0));
    const float* below = measured_log_.row(phase, row);
    put(channel++, [&](int x) { return std::clamp(above[x] - below[x], -1.0F, 1.0F); });
  }
  if (layer == 0) return;
  for (int pixel = 0; pixel < self.probability.channels(); ++pixel) {
    const float* probability = layers_[layer - 1].probability.row(pixel, row);
    put(channel++, [&](int x) { return probability[x] - 0.5F; });
  }
}

kernels::TwoModesInput TwoModesNetwork::modes_input(int layer, std::size_t pixel, int row,
                                                    const float* outputs,
                                                    std::int64_t channel_stride) const {
  const ComputedPixel& computed = computed_[pixel];
  return {.outputs = outputs + static_cast<std::int64_t>(pixel) * channel_stride,
          .group_stride = static_cast<std::int64_t>(computed_.size()) * channel_stride,
          .above = measured_log_.row(computed.phase, measured_row_above(computed, row)),
          .below = measured_log_.row(computed.phase, measured_row_below(computed, row)),
          .middle = layers_[layer].h.row(computed.channel, row),
          .columns = columns_};
}

/// Hands Z and the memory of a layer to the next one.
void TwoModesNetwork::next_h_row(int layer, int row, const float* memory,
                                 std::int64_t channel_stride) {
  const Layer& self = layers_[layer];
  Layer& next = layers_[layer + 1];
  for (int phase = 0; phase < tile_.columns; ++phase) {
    const int channel = description_.measured_rows.offset * tile_.columns + phase;
    std::copy_n(measured_log_.row(phase, row), columns_, next.h.row(channel, row));
  }
  for (std::size_t pixel = 0; pixel < computed_.size(); ++pixel) {
    std::copy_n(self.z.row(static_cast<int>(pixel), row), columns_,
                next.h.row(computed_[pixel].channel, row));
  }
  Tensor& input = next.values.front();
  const int first = input.channels() - shape_.memory;
  for (int channel = first; channel < input.channels(); ++channel) {
    std::copy_n(memory + (channel - first) * channel_stride, columns_, input.row(channel, row));
    input.fill_border(channel, row);
  }
}

/// A layer's head and what it says of each pixel; of the last one, the result.
void TwoModesNetwork::say_modes(int layer, const RangeImage& measured, float tolerance_m) {
  const kernels::RowKernels& kernels = kernels::row_kernels(instruction_set_);
  Layer& self = layers_[layer];
  const bool last = is_last_layer(shape_, layer);
  const std::int64_t stride = measured_log_.padded_columns();
  const int outputs = two_modes_outputs(shape_, layer);
  const auto pixels = static_cast<std::int64_t>(computed_.size());
#pragma omp for schedule(static)
  for (int row = 0; row < rows_; ++row) {
    float* of_head = scratch_[omp_get_thread_num()].data();
    float* ranges = of_head + outputs * stride;
    float* confidences = ranges + pixels * stride;
    self.graph.last_step_row(self.values, row, of_head, stride);
    for (std::int64_t pixel = 0; pixel < pixels; ++pixel) {
      kernels.two_modes({.in = modes_input(layer, pixel, row, of_head, stride),
                         .tolerance_m = tolerance_m,
                         .confidence_exponent = description_.confidence_exponent,
                         .log_range = self.z.row(static_cast<int>(pixel), row),
                         .probability = self.probability.row(static_cast<int>(pixel), row),
                         .range_m = last ? ranges + pixel * stride : nullptr,
                         .confidence = last ? confidences + pixel * stride : nullptr});
    }
    if (last) {
      finish_image_row(measured, row, ranges, confidences);
    } else {
      next_h_row(layer, row, of_head + kTwoModesOutputs * pixels * stride, stride);
    }
  }
}

/// One layer, all of it.
void TwoModesNetwork::run_layer(int layer, const RangeImage& measured, float tolerance_m) {
#pragma omp for schedule(static)
  for (int row = 0; row < rows_; ++row) {
    if (layer == 0) start_row(row);
    make_input_row(layer, row);
  }
  layers_[layer].graph.forward(layers_[layer].values, 1);
  say_modes(layer, measured, tolerance_m);
}

/// One row of tiles of the result: measured pixels as they were, computed ones within the sensor's
/// limits.
void TwoModesNetwork::finish_image_row(const RangeImage& measured, int row, const float* ranges,
                                       const float* confidences) {
  RangeImage& image = lifted_.image;
  const std::int64_t stride = measured_log_.padded_columns();
  const auto nearest_m = static_cast<float>(description_.sensor.min_range_m);
  const auto farthest_m = static_cast<float>(description_.sensor.max_range_m);
  for (std::size_t pixel = 0; pixel < computed_.size(); ++pixel) {
    const int channel = computed_[pixel].channel;
    const std::size_t first =
        image.index(row * tile_.rows + channel / tile_.columns, channel % tile_.columns);
    float* range_m = &image.range_m[first];
    float* confidence = &lifted_.confidence[first];
    const float* range = ranges + static_cast<std::int64_t>(pixel) * stride;
    const float* sure = confidences + static_cast<std::int64_t>(pixel) * stride;
    for (int x = 0; x < columns_; ++x) {
      const bool there = range[x] >= nearest_m && range[x] <= farthest_m;
      range_m[x * tile_.columns] = there ? range[x] : 0.0F;
      confidence[x * tile_.columns] = there ? sure[x] : 0.0F;
    }
  }
  const std::size_t first = image.index(row * tile_.rows + description_.measured_rows.offset, 0);
  for (int column = 0; column < image.columns; ++column) {
    const bool valid =
        measured_valid_.at(column % tile_.columns, row, column / tile_.columns) > 0.0F;
    image.range_m[first + column] = valid ? measured.at(row, column) : 0.0F;
    lifted_.confidence[first + column] = valid ? 1.0F : 0.0F;
  }
}

const LiftedImage& TwoModesNetwork::lift(const RangeImage& measured, float tolerance_m) {
  check(measured);
#pragma omp parallel num_threads(threads_)
  {
    take_measured(measured);
    for (int layer = 0; layer < static_cast<int>(layers_.size()); ++layer) {
      run_layer(layer, measured, tolerance_m);
    }
  }
  return lifted_;
}

}  // namespace hqslam::nn
