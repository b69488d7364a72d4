#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace hqslam::nn {

/// Channels, kernel, stride and padding of conv2d or conv_transpose2d. How columns are padded is
/// the tensor's affair (ColumnPadding).
struct ConvolutionShape {
  int input_channels = 1;
  int output_channels = 1;
  int kernel_rows = 3;
  int kernel_columns = 3;
  int stride = 1;  ///< of rows, and of columns unless stride_columns says otherwise
  int padding_rows = 1;
  int padding_columns = 1;
  std::optional<int> stride_columns = std::nullopt;
  bool transposed = false;

  int column_stride() const { return stride_columns.value_or(stride); }
  std::int64_t weights() const {
    return static_cast<std::int64_t>(input_channels) * output_channels * kernel_rows *
           kernel_columns;
  }
};

/// Throws Error with field, value and constraint: channels 1 to 4096, kernels 1 to 15, stride 1 to
/// 8, padding 0 to 15.
void validate(const ConvolutionShape& shape);

/// (size + 2 padding - kernel) / stride + 1
int convolved_size(int size, int kernel, int stride, int padding);

}  // namespace hqslam::nn
