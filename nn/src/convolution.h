#pragma once

#include <cstdint>
#include <optional>

#include "tensor.h"

// A convolution: its sizes and its definition.
namespace hqslam::nn {

/// Channels, kernel, stride and padding of conv2d or conv_transpose2d.
///
/// 2-D convolution (cross-correlation, as everywhere in deep learning) is
///   output[o][y][x] = bias[o] + sum_{i, r, c} weight[o][i][r][c]
///                                input[i][y stride + r - padding][x stride + c - padding]
/// or, for a `transposed` shape, its adjoint ("deconvolution"):
///   output[o][y stride + r - padding][x stride + c - padding] += weight[i][o][r][c] input[i][y][x]
/// plus bias[o]. Rows beyond the edge are zero or dropped, columns continue according to the
/// tensors' ColumnPadding. weight: output x input x kernel rows x kernel columns, transposed:
/// input x output x ...; bias: output channels.
struct ConvolutionShape {
  int input_channels = 1;
  int output_channels = 1;
  int kernel_rows = 3;
  int kernel_columns = 3;
  int stride = 1;  ///< of rows, and of columns without stride_columns
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

/// Throws Error with field, value and constraint: channels 1 to 4096, kernels 1 to 15, rows' stride
/// 1 to 8, columns' 1 or 2, padding 0 to 15.
void validate(const ConvolutionShape& shape);

/// Input and output channels change places.
ConvolutionShape adjoint_of(ConvolutionShape shape);

/// (size + 2 padding - kernel) / stride + 1
int convolved_size(int size, int kernel, int stride, int padding);

/// What a layer does with the sums it has computed: result = a(sum + skip), a(v) = max(v, slope v).
///
/// With `activated`, the result of an activation max(v, negative_slope v), the sums are gradients
/// of it and are multiplied by its derivative there: the result is the gradient of what went into
/// it.
struct LayerEnd {
  float negative_slope = 1.0F;   ///< 1 linear, 0 ReLU
  const Tensor* skip = nullptr;  ///< of the result's shape; may be the result
  const Tensor* activated = nullptr;
};

}  // namespace hqslam::nn
