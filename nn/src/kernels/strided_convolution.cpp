#include "strided_convolution.h"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>

#include "hqslam/core/error.h"

namespace hqslam::nn::kernels {
namespace {

int blocks_of(int channels) { return (channels + kOutputBlock - 1) / kOutputBlock; }

int padded_gradient_channels(int channels) {
  return (channels + kGradientBlock - 1) / kGradientBlock * kGradientBlock;
}

/// floor(a / b) for b > 0, also where a is negative.
int floor_divided(int a, int b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

/// to[x] = from[x stride]
void take_every(const float* from, int stride, int count, float* to) {
  for (int x = 0; x < count; ++x) to[x] = from[x * stride];
}

/// The phases of a row, `phase_stride` apart, put together: to[x stride + phase] =
/// phases[phase][x].
void merge_phases(const float* phases, std::int64_t phase_stride, int stride, int columns,
                  float* to) {
  if (stride == 1) {
    std::copy_n(phases, columns, to);
    return;
  }
  for (int x = 0; x < columns; ++x) to[x] = phases[x % stride * phase_stride + x / stride];
}

/// values = a(values + skip)
void end_row(const float* skip, const float* activated, float negative_slope, int count,
             float* values) {
  if (skip != nullptr) {
#pragma omp simd
    for (int x = 0; x < count; ++x) values[x] += skip[x];
  }
  if (negative_slope == 1.0F) return;
  if (activated != nullptr) {
#pragma omp simd
    for (int x = 0; x < count; ++x) {
      const float scaled = negative_slope * values[x];
      values[x] = activated[x] > 0.0F ? values[x] : scaled;
    }
    return;
  }
  for (int x = 0; x < count; ++x) values[x] = std::max(values[x], negative_slope * values[x]);
}

}  // namespace

StridedConvolution::StridedConvolution(const ConvolutionShape& shape, const Tensor& narrow,
                                       const Tensor& wide, InstructionSet instruction_set)
    : shape_(shape),
      padding_(wide.padding()),
      narrow_rows_(narrow.rows()),
      narrow_columns_(narrow.columns()),
      wide_rows_(wide.rows()),
      wide_columns_(wide.columns()),
      kernels_(&row_kernels(instruction_set)) {
  validate(shape_);
  check(narrow, wide);
  plan_gather(wide);
  plan_scatter(narrow);
}

/// Everything that the kernels will read must be inside the tensors' memory, and what a tap finds
/// there must be what the wide tensor has.
void StridedConvolution::check(const Tensor& narrow, const Tensor& wide) const {
  const ConvolutionShape& s = shape_;
  if (wide.channels() != s.input_channels || narrow.channels() != s.output_channels) {
    throw Error(fmt::format("convolution: tensors of {} and {} channels, expected {} and {}",
                            wide.channels(), narrow.channels(), s.input_channels,
                            s.output_channels));
  }
  if (narrow.rows() != convolved_size(wide.rows(), s.kernel_rows, s.stride, s.padding_rows)) {
    throw Error(fmt::format("convolution: {} rows do not become {} with stride {}", wide.rows(),
                            narrow.rows(), s.stride));
  }
  const int stride = s.column_stride();
  const bool circular = wide.padding() == ColumnPadding::kCircular;
  const int columns =
      circular ? wide.columns() / stride
               : convolved_size(wide.columns(), s.kernel_columns, stride, s.padding_columns);
  if (narrow.columns() != columns || (circular && wide.columns() % stride != 0) ||
      narrow.padding() != wide.padding() || wide.columns() > narrow.padded_columns() * stride) {
    throw Error(fmt::format("convolution: {} columns do not become {} with stride {}",
                            wide.columns(), narrow.columns(), stride));
  }
  check_columns_read(narrow, wide);
  const int below = (narrow.rows() - 1) * s.stride + s.kernel_rows - s.padding_rows - wide.rows();
  const int wide_border = std::max(s.padding_rows, below);
  const int narrow_above = (s.kernel_rows - 1 - s.padding_rows + s.stride - 1) / s.stride;
  const int narrow_below = (wide.rows() - 1 + s.padding_rows) / s.stride - (narrow.rows() - 1);
  const int narrow_border = std::max({0, narrow_above, narrow_below});
  if (wide.border_rows() < wide_border || narrow.border_rows() < narrow_border) {
    throw Error(fmt::format("convolution: borders of {} and {} rows, expected {} and {}",
                            wide.border_rows(), narrow.border_rows(), wide_border, narrow_border));
  }
}

void StridedConvolution::check_columns_read(const Tensor& narrow, const Tensor& wide) const {
  const ConvolutionShape& s = shape_;
  const int stride = s.column_stride();
  const int last = s.kernel_columns - 1 - s.padding_columns;  // the last tap's column
  // Without a stride the rows are read in whole vectors: as many as the narrow row takes.
  const bool beyond_border = stride == 1 && narrow.padded_columns() + std::max(0, last) >
                                                wide.padded_columns() + Tensor::kBorderColumns;
  // With one, a phase plane is as wide as the narrow row, and zero beyond: a tap that reads there
  // must have nothing left to read in the wide row.
  bool beyond_plane = false;
  for (int column = stride; stride > 1 && column <= last; ++column) {
    const int phase = column % stride;
    beyond_plane |= narrow.columns() * stride + phase < wide.columns();
  }
  if (wide.padding() == ColumnPadding::kZero && (beyond_border || beyond_plane)) {
    throw Error(fmt::format(
        "convolution: kernel of {} columns, stride {} and padding {} on {} columns with zeros "
        "beyond the edge, expected a padding that makes {} columns of them",
        s.kernel_columns, stride, s.padding_columns, wide.columns(),
        (wide.columns() + stride - 1) / stride));
  }
}

void StridedConvolution::plan_gather(const Tensor& wide) {
  const ConvolutionShape& s = shape_;
  const int stride = s.column_stride();
  // With a stride the taps read the phase planes: wide columns of one phase side by side.
  const Tensor phases = stride == 1 ? Tensor() : make_phases();
  const Tensor& planes = stride == 1 ? wide : phases;
  for (int b = 0; b < s.input_channels; ++b) {
    for (int i = 0; i < s.kernel_rows; ++i) {
      for (int j = 0; j < s.kernel_columns; ++j) {
        const int column = j - s.padding_columns;
        const int shift = floor_divided(column, stride);
        const int plane = b * stride + (column - shift * stride);
        gather_offset_.push_back(plane * planes.channel_stride() + i * planes.row_stride() + shift);
      }
    }
  }
}

void StridedConvolution::plan_scatter(const Tensor& narrow) {
  const ConvolutionShape& s = shape_;
  const int kernel = s.kernel_rows * s.kernel_columns;
  for (int row_phase = 0; row_phase < s.stride; ++row_phase) {
    for (int column_phase = 0; column_phase < s.column_stride(); ++column_phase) {
      ScatterPhase phase;
      for (int a = 0; a < s.output_channels; ++a) {
        for (int i = 0; i < s.kernel_rows; ++i) {
          const int row = row_phase + s.padding_rows - i;
          if (row % s.stride != 0) continue;
          for (int j = 0; j < s.kernel_columns; ++j) {
            const int column = column_phase + s.padding_columns - j;
            if (column % s.column_stride() != 0) continue;
            phase.tap_offset.push_back(a * narrow.channel_stride() +
                                       row / s.stride * narrow.row_stride() +
                                       column / s.column_stride());
            phase.weight_index.push_back(static_cast<std::int64_t>(a) * s.input_channels * kernel +
                                         i * s.kernel_columns + j);
          }
        }
      }
      scatter_phases_.push_back(std::move(phase));
    }
  }
}

void StridedConvolution::set_weights(std::span<const float> weights) {
  const ConvolutionShape& s = shape_;
  if (static_cast<std::int64_t>(weights.size()) != s.weights()) {
    throw Error(fmt::format("convolution: {} weights, expected {}", weights.size(), s.weights()));
  }
  const std::size_t taps = gather_offset_.size();
  gather_weights_.assign(blocks_of(s.output_channels) * taps * kOutputBlock, 0.0F);
  for (int a = 0; a < s.output_channels; ++a) {
    for (std::size_t t = 0; t < taps; ++t) {
      gather_weights_[((a / kOutputBlock) * taps + t) * kOutputBlock + a % kOutputBlock] =
          weights[a * taps + t];
    }
  }
  const std::int64_t kernel = static_cast<std::int64_t>(s.kernel_rows) * s.kernel_columns;
  for (ScatterPhase& phase : scatter_phases_) {
    const std::size_t phase_taps = phase.tap_offset.size();
    phase.weights.assign(blocks_of(s.input_channels) * phase_taps * kOutputBlock, 0.0F);
    for (int b = 0; b < s.input_channels; ++b) {
      for (std::size_t t = 0; t < phase_taps; ++t) {
        phase.weights[((b / kOutputBlock) * phase_taps + t) * kOutputBlock + b % kOutputBlock] =
            weights[phase.weight_index[t] + b * kernel];
      }
    }
  }
}

Tensor StridedConvolution::make_phases() const {
  const int stride = shape_.column_stride();
  const int rows = (std::min(kBlockRows, narrow_rows_) - 1) * shape_.stride + shape_.kernel_rows;
  return {shape_.input_channels * stride, rows, narrow_columns_, padding_, 0};
}

ConvolutionScratch StridedConvolution::make_scratch(int threads) const {
  ConvolutionScratch scratch;
  if (shape_.column_stride() > 1) scratch.phases.assign(threads, make_phases());
  // A row of every wide channel and column phase (scatter), or the gradient of every weight
  // (add_weight_gradient).
  const Tensor row(1, 1, narrow_columns_, padding_, 0);
  const std::size_t scatter_floats =
      static_cast<std::size_t>(shape_.input_channels) * shape_.column_stride() * row.row_stride();
  const std::size_t channels = padded_gradient_channels(shape_.output_channels);
  const std::size_t gradient_floats = channels * gather_offset_.size();
  scratch.rows.assign(threads, std::vector<float>(std::max(scatter_floats, gradient_floats)));
  return scratch;
}

void StridedConvolution::sort_phases(const Tensor& wide, int first_row, int rows,
                                     Tensor& phases) const {
  const int stride = shape_.column_stride();
  // The border of the wide row holds what lies beyond its last column, as far as it is needed.
  const int columns = std::min(narrow_columns_, (wide_columns_ + Tensor::kBorderColumns) / stride);
  for (int y = 0; y < rows; ++y) {
    for (int channel = 0; channel < shape_.input_channels; ++channel) {
      const int first = channel * stride;
      const float* from = wide.row(channel, first_row + y);
      if (stride == 2 && columns == narrow_columns_) {
        kernels_->split({.input = from,
                         .even = phases.row(first, y),
                         .odd = phases.row(first + 1, y),
                         .columns = columns});
      } else {
        for (int phase = 0; phase < stride; ++phase) {
          take_every(from + phase, stride, columns, phases.row(first + phase, y));
        }
      }
      for (int phase = 0; phase < stride; ++phase) phases.fill_border(first + phase, y);
    }
  }
}

StridedConvolution::GatherRows StridedConvolution::gather_rows(const Tensor& wide, int begin,
                                                               int end,
                                                               ConvolutionScratch& scratch) const {
  const int first_row = begin * shape_.stride - shape_.padding_rows;
  if (shape_.column_stride() == 1) {
    return {wide.row(0, first_row), shape_.stride * wide.row_stride()};
  }
  Tensor& phases = scratch.phases[omp_get_thread_num()];
  const int rows = (end - begin - 1) * shape_.stride + shape_.kernel_rows;
  sort_phases(wide, first_row, rows, phases);
  return {phases.row(0, 0), shape_.stride * phases.row_stride()};
}

AccumulateRow StridedConvolution::gather_task(const float* input, const float* bias) const {
  AccumulateRow row;
  row.input = input;
  row.tap_offset = gather_offset_.data();
  row.taps = static_cast<int>(gather_offset_.size());
  row.weights = gather_weights_.data();
  row.bias = bias;
  row.output_channels = shape_.output_channels;
  row.end = narrow_columns_;
  return row;
}

void StridedConvolution::end_in(Tensor& result, const Epilogue& epilogue, int y,
                                AccumulateRow& row) {
  row.output = result.row(0, y);
  row.output_channel_stride = result.channel_stride();
  row.negative_slope = epilogue.negative_slope;
  if (epilogue.skip != nullptr) {
    row.skip = epilogue.skip->row(0, y);
    row.skip_channel_stride = epilogue.skip->channel_stride();
  }
  if (epilogue.activated != nullptr) {
    row.activated = epilogue.activated->row(0, y);
    row.activated_channel_stride = epilogue.activated->channel_stride();
  }
}

void StridedConvolution::gather(const Tensor& wide, const Epilogue& epilogue, Tensor& narrow,
                                ConvolutionScratch& scratch) const {
  // Without a stride a block would save nothing.
  const int of_a_thread = (narrow_rows_ + omp_get_num_threads() - 1) / omp_get_num_threads();
  const int most = shape_.column_stride() == 1 ? 1 : std::min(kBlockRows, of_a_thread);
  const int blocks = (narrow_rows_ + most - 1) / most;
#pragma omp for schedule(static)
  for (int block = 0; block < blocks; ++block) {
    const int begin = block * most;
    const int end = std::min(begin + most, narrow_rows_);
    const GatherRows rows = gather_rows(wide, begin, end, scratch);
    for (int y = begin; y < end; ++y) {
      AccumulateRow row = gather_task(rows.first + (y - begin) * rows.row_stride, epilogue.bias);
      end_in(narrow, epilogue, y, row);
      kernels_->accumulate(row);
      for (int channel = 0; channel < shape_.output_channels; ++channel) {
        narrow.fill_border(channel, y);
      }
    }
  }
}

void StridedConvolution::gather_row(const Tensor& wide, const float* bias, int y, float* output,
                                    std::int64_t channel_stride) const {
  AccumulateRow row = gather_task(wide.row(0, y * shape_.stride - shape_.padding_rows), bias);
  row.output = output;
  row.output_channel_stride = channel_stride;
  kernels_->accumulate(row);
}

void StridedConvolution::scatter_whole_row(AccumulateRow row, const Epilogue& epilogue,
                                           int wide_row, Tensor& wide) const {
  const ScatterPhase& taps = scatter_phases_[wide_row % shape_.stride];
  row.tap_offset = taps.tap_offset.data();
  row.taps = static_cast<int>(taps.tap_offset.size());
  row.weights = taps.weights.data();
  row.bias = epilogue.bias;
  row.output_channels = shape_.input_channels;
  row.end = wide_columns_;
  end_in(wide, epilogue, wide_row, row);
  kernels_->accumulate(row);
  for (int channel = 0; channel < shape_.input_channels; ++channel) {
    wide.fill_border(channel, wide_row);
  }
}

void StridedConvolution::scatter_rows(const Tensor& narrow, int first_row, const Epilogue& epilogue,
                                      Tensor& wide) const {
  AccumulateRow row;
  for (int y = 0; y < narrow.rows(); ++y) {
    row.input = narrow.row(0, y);
    scatter_whole_row(row, epilogue, first_row + y, wide);
  }
}

void StridedConvolution::scatter_row(const Tensor& narrow, const Epilogue& epilogue, int wide_row,
                                     Tensor& wide, std::vector<float>& rows) const {
  const int stride = shape_.column_stride();
  const int row_phase = wide_row % shape_.stride;
  const std::int64_t row_stride = narrow.channel_stride();
  AccumulateRow row;
  row.input = narrow.row(0, wide_row / shape_.stride);
  row.bias = epilogue.bias;
  row.output_channels = shape_.input_channels;
  row.output_channel_stride = stride * row_stride;
  row.end = (wide_columns_ + stride - 1) / stride;
  if (stride == 1) {
    scatter_whole_row(row, epilogue, wide_row, wide);
    return;
  }
  for (int phase = 0; phase < stride; ++phase) {
    const ScatterPhase& taps = scatter_phases_[row_phase * stride + phase];
    row.tap_offset = taps.tap_offset.data();
    row.taps = static_cast<int>(taps.tap_offset.size());
    row.weights = taps.weights.data();
    row.output = rows.data() + phase * row_stride;
    kernels_->accumulate(row);
  }
  for (int channel = 0; channel < shape_.input_channels; ++channel) {
    float* to = wide.row(channel, wide_row);
    const float* skip = epilogue.skip == nullptr ? nullptr : epilogue.skip->row(channel, wide_row);
    const float* from = rows.data() + channel * stride * row_stride;
    const float* activated =
        epilogue.activated == nullptr ? nullptr : epilogue.activated->row(channel, wide_row);
    if (stride == 2) {
      kernels_->merge({.even = from,
                       .odd = from + row_stride,
                       .skip = skip,
                       .activated = activated,
                       .negative_slope = epilogue.negative_slope,
                       .output = to,
                       .columns = row.end});
    } else {
      merge_phases(from, row_stride, stride, wide_columns_, to);
      end_row(skip, activated, epilogue.negative_slope, wide_columns_, to);
    }
    wide.fill_border(channel, wide_row);
  }
}

void StridedConvolution::scatter(const Tensor& narrow, const Epilogue& epilogue, Tensor& wide,
                                 ConvolutionScratch& scratch) const {
#pragma omp for schedule(static)
  for (int y = 0; y < wide_rows_; ++y) {
    scatter_row(narrow, epilogue, y, wide, scratch.rows[omp_get_thread_num()]);
  }
}

void StridedConvolution::add_weight_gradient(const Tensor& narrow, int first_row,
                                             const Tensor& wide, std::span<float> gradient,
                                             ConvolutionScratch& scratch) const {
  const int channels = padded_gradient_channels(shape_.output_channels);
  const int taps = static_cast<int>(gather_offset_.size());
  float* sums = scratch.rows.front().data();
  std::fill_n(sums, static_cast<std::size_t>(channels) * taps, 0.0F);
  // As many rows at a time as a block of channels may have in the first-level cache.
  constexpr int kCachedFloats = 6144;
  const int cached = std::max(1, kCachedFloats / (kGradientBlock * narrow_columns_));
  const int most = shape_.column_stride() == 1 ? cached : std::min(cached, kBlockRows);
  const int parts = (narrow.rows() + most - 1) / most;
  for (int part = 0; part < parts; ++part) {
    const int begin = part * narrow.rows() / parts;
    const int end = (part + 1) * narrow.rows() / parts;
    const GatherRows rows = gather_rows(wide, first_row + begin, first_row + end, scratch);
    kernels_->correlate({.narrow = narrow.row(0, begin),
                         .narrow_channel_stride = narrow.channel_stride(),
                         .narrow_row_stride = narrow.row_stride(),
                         .narrow_channels = shape_.output_channels,
                         .wide = rows.first,
                         .wide_row_stride = rows.row_stride,
                         .tap_offset = gather_offset_.data(),
                         .taps = taps,
                         .rows = end - begin,
                         .columns = narrow_columns_,
                         .gradient = sums});
  }
  for (int a = 0; a < shape_.output_channels; ++a) {
    for (int t = 0; t < taps; ++t) gradient[a * taps + t] += sums[t * channels + a];
  }
}

}  // namespace hqslam::nn::kernels
