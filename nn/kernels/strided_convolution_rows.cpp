#include <omp.h>

#include <algorithm>

#include "strided_convolution.h"

// The plan of StridedConvolution, carried out row by row.
namespace hqslam::nn::kernels {

void StridedConvolution::sort_phases(const Tensor& wide, int first_row, int rows,
                                     Tensor& phases) const {
  for (int y = 0; y < rows; ++y) {
    for (int channel = 0; channel < shape_.input_channels; ++channel) {
      const int even = 2 * channel;
      kernels_->split({.input = wide.row(channel, first_row + y),
                       .even = phases.row(even, y),
                       .odd = phases.row(even + 1, y),
                       .columns = narrow_columns_});
      phases.fill_border(even, y);
      phases.fill_border(even + 1, y);
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

void StridedConvolution::end_in(Tensor& result, const LayerEnd& end, int y, AccumulateRow& row) {
  row.output = result.row(0, y);
  row.output_channel_stride = result.channel_stride();
  row.negative_slope = end.negative_slope;
  if (end.skip != nullptr) {
    row.skip = end.skip->row(0, y);
    row.skip_channel_stride = end.skip->channel_stride();
  }
  if (end.activated != nullptr) {
    row.activated = end.activated->row(0, y);
    row.activated_channel_stride = end.activated->channel_stride();
  }
}

void StridedConvolution::gather(const Tensor& wide, const float* bias, const LayerEnd& end,
                                Tensor& narrow, ConvolutionScratch& scratch) const {
  // Without a stride a block would save nothing.
  const int of_a_thread = (narrow_rows_ + omp_get_num_threads() - 1) / omp_get_num_threads();
  const int most = shape_.column_stride() == 1 ? 1 : std::min(kBlockRows, of_a_thread);
  const int blocks = (narrow_rows_ + most - 1) / most;
#pragma omp for schedule(static)
  for (int block = 0; block < blocks; ++block) {
    const int begin = block * most;
    const int after = std::min(begin + most, narrow_rows_);
    const GatherRows rows = gather_rows(wide, begin, after, scratch);
    for (int y = begin; y < after; ++y) {
      AccumulateRow row = gather_task(rows.first + (y - begin) * rows.row_stride, bias);
      end_in(narrow, end, y, row);
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

void StridedConvolution::scatter_taps(int phase, AccumulateRow& row) const {
  const ScatterPhase& taps = scatter_phases_[phase];
  row.tap_offset = taps.tap_offset.data();
  row.taps = static_cast<int>(taps.tap_offset.size());
  row.weights = taps.weights.data();
}

void StridedConvolution::scatter_whole_row(AccumulateRow row, const LayerEnd& end, int wide_row,
                                           Tensor& wide) const {
  scatter_taps(wide_row % shape_.stride, row);
  row.output_channels = shape_.input_channels;
  row.end = wide_columns_;
  end_in(wide, end, wide_row, row);
  kernels_->accumulate(row);
  for (int channel = 0; channel < shape_.input_channels; ++channel) {
    wide.fill_border(channel, wide_row);
  }
}

void StridedConvolution::scatter_rows(const Tensor& narrow, int first_row, const LayerEnd& end,
                                      Tensor& wide) const {
  AccumulateRow row;
  for (int y = 0; y < narrow.rows(); ++y) {
    row.input = narrow.row(0, y);
    scatter_whole_row(row, end, first_row + y, wide);
  }
}

void StridedConvolution::scatter_row(const Tensor& narrow, const float* bias, const LayerEnd& end,
                                     int wide_row, Tensor& wide, std::vector<float>& rows) const {
  const int stride = shape_.column_stride();
  const std::int64_t row_stride = narrow.channel_stride();
  AccumulateRow row;
  row.input = narrow.row(0, wide_row / shape_.stride);
  row.bias = bias;
  if (stride == 1) {
    scatter_whole_row(row, end, wide_row, wide);
    return;
  }
  row.output_channels = shape_.input_channels;
  row.output_channel_stride = stride * row_stride;
  row.end = (wide_columns_ + stride - 1) / stride;
  for (int phase = 0; phase < stride; ++phase) {
    scatter_taps(wide_row % shape_.stride * stride + phase, row);
    row.output = rows.data() + phase * row_stride;
    kernels_->accumulate(row);
  }
  for (int channel = 0; channel < shape_.input_channels; ++channel) {
    const auto row_of = [&](const Tensor* tensor) {
      return tensor == nullptr ? nullptr : tensor->row(channel, wide_row);
    };
    const float* phases = rows.data() + channel * stride * row_stride;
    kernels_->merge({.even = phases,
                     .odd = phases + row_stride,
                     .skip = row_of(end.skip),
                     .activated = row_of(end.activated),
                     .negative_slope = end.negative_slope,
                     .output = wide.row(channel, wide_row),
                     .columns = row.end});
    wide.fill_border(channel, wide_row);
  }
}

void StridedConvolution::scatter(const Tensor& narrow, const float* bias, const LayerEnd& end,
                                 Tensor& wide, ConvolutionScratch& scratch) const {
#pragma omp for schedule(static)
  for (int y = 0; y < wide_rows_; ++y) {
    scatter_row(narrow, bias, end, y, wide, scratch.rows[omp_get_thread_num()]);
  }
}

}  // namespace hqslam::nn::kernels
