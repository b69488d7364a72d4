#include "strided_convolution.h"

#include <algorithm>

#include "hqslam/core/error.h"

namespace hqslam::nn::kernels {
namespace {

/// Blocks of 8 channels x taps x 8; weight_of(channel, tap).
template <typename WeightOf>
void pack(int channels, std::size_t taps, const WeightOf& weight_of, std::vector<float>& packed) {
  packed.assign(whole_blocks(channels) * taps, 0.0F);
  for (int c = 0; c < channels; ++c) {
    for (std::size_t t = 0; t < taps; ++t) {
      packed[((c / kOutputBlock) * taps + t) * kOutputBlock + c % kOutputBlock] = weight_of(c, t);
    }
  }
}

/// floor(a / b) for b > 0, also where a is negative.
int floor_divided(int a, int b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

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
    throw Error("convolution: tensors of {} and {} channels, expected {} and {}", wide.channels(),
                narrow.channels(), s.input_channels, s.output_channels);
  }
  if (narrow.rows() != convolved_size(wide.rows(), s.kernel_rows, s.stride, s.padding_rows)) {
    throw Error("convolution: {} rows do not become {} with stride {}", wide.rows(), narrow.rows(),
                s.stride);
  }
  const int stride = s.column_stride();
  const bool circular = wide.padding() == ColumnPadding::kCircular;
  const int columns =
      circular ? wide.columns() / stride
               : convolved_size(wide.columns(), s.kernel_columns, stride, s.padding_columns);
  if (narrow.columns() != columns || (circular && wide.columns() % stride != 0) ||
      narrow.padding() != wide.padding() || wide.columns() > narrow.padded_columns() * stride) {
    throw Error("convolution: {} columns do not become {} with stride {}", wide.columns(),
                narrow.columns(), stride);
  }
  check_columns_read(narrow, wide);
  const int below = (narrow.rows() - 1) * s.stride + s.kernel_rows - s.padding_rows - wide.rows();
  const int wide_border = std::max(s.padding_rows, below);
  const int narrow_above = (s.kernel_rows - 1 - s.padding_rows + s.stride - 1) / s.stride;
  const int narrow_below = (wide.rows() - 1 + s.padding_rows) / s.stride - (narrow.rows() - 1);
  const int narrow_border = std::max({0, narrow_above, narrow_below});
  if (wide.border_rows() < wide_border || narrow.border_rows() < narrow_border) {
    throw Error("convolution: borders of {} and {} rows, expected {} and {}", wide.border_rows(),
                narrow.border_rows(), wide_border, narrow_border);
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
  // must have nothing left to read in the wide row, of which whole vectors are split.
  const bool beyond_plane =
      stride == 2 && ((last >= 2 && 2 * narrow.columns() < wide.columns()) ||
                      2 * narrow.padded_columns() > wide.padded_columns() + Tensor::kBorderColumns);
  if (wide.padding() == ColumnPadding::kZero && (beyond_border || beyond_plane)) {
    throw Error(
        "convolution: kernel of {} columns, stride {} and padding {} on {} columns with zeros "
        "beyond the edge, expected a padding that makes {} columns of them",
        s.kernel_columns, stride, s.padding_columns, wide.columns(),
        (wide.columns() + stride - 1) / stride);
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
    throw Error("convolution: {} weights, expected {}", weights.size(), s.weights());
  }
  const std::size_t taps = gather_offset_.size();
  pack(
      s.output_channels, taps, [&](int a, std::size_t t) { return weights[a * taps + t]; },
      gather_weights_);
  const std::int64_t kernel = static_cast<std::int64_t>(s.kernel_rows) * s.kernel_columns;
  for (ScatterPhase& phase : scatter_phases_) {
    const auto weight_of = [&](int b, std::size_t t) {
      return weights[phase.weight_index[t] + b * kernel];
    };
    pack(s.input_channels, phase.tap_offset.size(), weight_of, phase.weights);
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
  const std::size_t gradient_floats = whole_blocks(shape_.output_channels) * gather_offset_.size();
  scratch.rows.assign(threads, std::vector<float>(std::max(scatter_floats, gradient_floats)));
  return scratch;
}

}  // namespace hqslam::nn::kernels
