#pragma once

#include <cstdint>

#include "convolution_shape.h"
#include "tensor.h"

// How the reference convolutions count; the fast ones have their own way, on purpose.
namespace hqslam::nn {

/// Index into weights of shape N x inner x kernel rows x kernel columns.
inline std::int64_t weight_index(const ConvolutionShape& shape, int outer_channel,
                                 int inner_channels, int inner_channel, int r, int c) {
  return ((static_cast<std::int64_t>(outer_channel) * inner_channels + inner_channel) *
              shape.kernel_rows +
          r) *
             shape.kernel_columns +
         c;
}

/// Calls visit(channel, r, c, row, column) for every value of `wide` that pixel (y, x) of the
/// narrow side is connected to. Rows beyond the edge are left out, columns too or go round.
template <typename Visit>
void for_each_tap(const ConvolutionShape& shape, const Tensor& wide, int y, int x,
                  const Visit& visit) {
  for (int channel = 0; channel < wide.channels(); ++channel) {
    for (int r = 0; r < shape.kernel_rows; ++r) {
      const int row = y * shape.stride + r - shape.padding_rows;
      if (row < 0 || row >= wide.rows()) continue;
      for (int c = 0; c < shape.kernel_columns; ++c) {
        int column = x * shape.column_stride() + c - shape.padding_columns;
        if (wide.padding() == ColumnPadding::kCircular) {
          column = (column % wide.columns() + wide.columns()) % wide.columns();
        }
        if (column < 0 || column >= wide.columns()) continue;
        visit(channel, r, c, row, column);
      }
    }
  }
}

}  // namespace hqslam::nn
