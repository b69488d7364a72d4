#include "tensor.h"

#include <algorithm>

#include "hqslam/core/error.h"

namespace hqslam::nn {

Tensor Tensor::shape_alone(int channels, int rows, int columns, ColumnPadding padding,
                           int border_rows) {
  constexpr int kMostBorderRows = 16;
  if (channels < 1 || rows < 1 || columns < 1 || border_rows < 0 || border_rows > kMostBorderRows) {
    throw Error(
        "tensor: {} channels, {} rows, {} columns, {} border rows; expected at least one of each "
        "and a border of 0 to {} rows",
        channels, rows, columns, border_rows, kMostBorderRows);
  }
  Tensor tensor;
  tensor.channels_ = channels;
  tensor.rows_ = rows;
  tensor.columns_ = columns;
  tensor.padded_columns_ = (columns + kBorderColumns - 1) / kBorderColumns * kBorderColumns;
  tensor.border_rows_ = border_rows;
  tensor.padding_ = padding;
  return tensor;
}

Tensor::Tensor(int channels, int rows, int columns, ColumnPadding padding, int border_rows)
    : Tensor(shape_alone(channels, rows, columns, padding, border_rows)) {
  allocate();
  set_zero();
}

void Tensor::allocate() {
  constexpr std::uintptr_t kLine = CacheLineAllocator<float>::kAlignment;
  values_.resize(rows_ + 2 * border_rows_ + 1, channels_, channel_stride());
  const std::uintptr_t beyond = reinterpret_cast<std::uintptr_t>(values_.data()) % kLine;
  first_ = static_cast<std::int64_t>((kLine - beyond) % kLine / sizeof(float));
}

Tensor& Tensor::operator=(const Tensor& other) {
  if (this == &other) return *this;
  channels_ = other.channels_;
  rows_ = other.rows_;
  columns_ = other.columns_;
  padded_columns_ = other.padded_columns_;
  border_rows_ = other.border_rows_;
  padding_ = other.padding_;
  if (other.values_.size() == 0) {
    values_ = {};
    return *this;
  }
  allocate();
  std::copy_n(other.values_.data() + other.first_, other.with_borders().size(),
              values_.data() + first_);
  return *this;
}

void Tensor::fill_other_border(int channel, int row_index) {
  float* values = row(channel, row_index);
  if (padding_ == ColumnPadding::kZero) {
    std::fill_n(values - kBorderColumns, kBorderColumns, 0.0F);
    std::fill(values + columns_, values + padded_columns_ + kBorderColumns, 0.0F);
    return;
  }
  // A row shorter than the border goes round more than once.
  for (int column = -1; column >= -kBorderColumns; --column) {
    values[column] = values[column + columns_];
  }
  for (int column = columns_; column < padded_columns_ + kBorderColumns; ++column) {
    values[column] = values[column - columns_];
  }
}

void Tensor::fill_borders() {
  for (int channel = 0; channel < channels_; ++channel) {
    for (int row_index = 0; row_index < rows_; ++row_index) {
      fill_border(channel, row_index);
    }
  }
}

void Tensor::set_zero() { values_.setZero(); }

void copy_channels(const Tensor& from, int from_channel, int channels, Tensor& to, int to_channel) {
#pragma omp for schedule(static)
  for (int row = 0; row < to.rows(); ++row) {
    copy_channels_row(from, from_channel, channels, row, to, to_channel);
  }
}

void copy_channels_row(const Tensor& from, int from_channel, int channels, int row, Tensor& to,
                       int to_channel) {
  for (int channel = 0; channel < channels; ++channel) {
    std::copy_n(from.row(from_channel + channel, row), to.columns(),
                to.row(to_channel + channel, row));
    to.fill_border(to_channel + channel, row);
  }
}

void add_channels(const Tensor& from, int first, Tensor& to) {
  const int channels = std::min(from.channels() - first, to.channels());
  for (int channel = 0; channel < channels; ++channel) {
    for (int y = 0; y < from.rows(); ++y) {
      const float* values = from.row(first + channel, y);
      float* sums = to.row(channel, y);
      for (int x = 0; x < from.columns(); ++x) sums[x] += values[x];
    }
  }
}

void clear_channels(int from_channel, Tensor& tensor) {
#pragma omp for schedule(static)
  for (int row = 0; row < tensor.rows(); ++row) clear_channels_row(from_channel, row, tensor);
}

void clear_channels_row(int from_channel, int row, Tensor& tensor) {
  for (int channel = from_channel; channel < tensor.channels(); ++channel) {
    std::fill_n(tensor.row(channel, row), tensor.columns(), 0.0F);
    tensor.fill_border(channel, row);
  }
}

}  // namespace hqslam::nn
