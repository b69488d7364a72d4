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

void Tensor::set_zero() { std::fill(values_.begin(), values_.end(), 0.0F); }

}  // namespace hqslam::nn
