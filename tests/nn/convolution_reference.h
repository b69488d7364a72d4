#pragma once

#include "convolution.h"

// The definition that the fast kernels are tested against, with index arithmetic of its own. The
// narrow side has one pixel per stride of the wide side, and the weights are narrow
// channels x wide channels x kernel rows x kernel columns.
namespace hqslam::nn {

/// Calls visit(channel, y, x) for every value.
template <typename Visit>
void for_each_value(const Tensor& tensor, const Visit& visit) {
  for (int channel = 0; channel < tensor.channels(); ++channel) {
    for (int y = 0; y < tensor.rows(); ++y) {
      for (int x = 0; x < tensor.columns(); ++x) visit(channel, y, x);
    }
  }
}

/// Calls visit(weight, channel, row, column) for every value of `wide` that the pixel (y, x) of a
/// narrow channel is connected to, and the index of the weight between them. Rows beyond the edge
/// are left out, and so are columns, unless they continue at the other end.
template <typename Visit>
void for_each_tap(const ConvolutionShape& shape, const Tensor& wide, int narrow_channel, int y,
                  int x, const Visit& visit) {
  auto weight = static_cast<std::size_t>(narrow_channel) * wide.channels() * shape.kernel_rows *
                shape.kernel_columns;
  for (int channel = 0; channel < wide.channels(); ++channel) {
    for (int r = 0; r < shape.kernel_rows; ++r) {
      const int row = y * shape.stride + r - shape.padding_rows;
      for (int c = 0; c < shape.kernel_columns; ++c, ++weight) {
        int column = x * shape.column_stride() + c - shape.padding_columns;
        if (wide.padding() == ColumnPadding::kCircular) {
          column = (column % wide.columns() + wide.columns()) % wide.columns();
        }
        if (row < 0 || row >= wide.rows() || column < 0 || column >= wide.columns()) continue;
        visit(weight, channel, row, column);
      }
    }
  }
}

/// Adds to the narrow side what comes from the wide one.
inline void gather(const ConvolutionShape& shape, std::span<const float> weights,
                   const Tensor& wide, Tensor& narrow) {
  for_each_value(narrow, [&](int a, int y, int x) {
    double sum = narrow.at(a, y, x);
    for_each_tap(shape, wide, a, y, x, [&](std::size_t weight, int b, int row, int column) {
      sum += static_cast<double>(weights[weight]) * wide.at(b, row, column);
    });
    narrow.at(a, y, x) = static_cast<float>(sum);
  });
}

/// Adds to the wide side what comes from the narrow one.
inline void scatter(const ConvolutionShape& shape, std::span<const float> weights,
                    const Tensor& narrow, Tensor& wide) {
  for_each_value(narrow, [&](int a, int y, int x) {
    for_each_tap(shape, wide, a, y, x, [&](std::size_t weight, int b, int row, int column) {
      wide.at(b, row, column) += weights[weight] * narrow.at(a, y, x);
    });
  });
}

/// As its formula (convolution.h) has it. The output's shape decides between those that one input
/// shape could have. bias: empty for none.
inline void conv2d_reference(const ConvolutionShape& shape, std::span<const float> weight,
                             std::span<const float> bias, const Tensor& input, Tensor& output) {
  for_each_value(output,
                 [&](int o, int y, int x) { output.at(o, y, x) = bias.empty() ? 0.0F : bias[o]; });
  if (shape.transposed) {
    scatter(shape, weight, input, output);
  } else {
    gather(shape, weight, input, output);
  }
  output.fill_borders();
}

/// The gradients, written as their derivatives. d_input is overwritten, the others are added to.
inline void conv2d_backward_reference(const ConvolutionShape& shape, std::span<const float> weight,
                                      const Tensor& input, const Tensor& d_output, Tensor& d_input,
                                      std::span<float> d_weight, std::span<float> d_bias) {
  d_input.set_zero();
  if (shape.transposed) {
    gather(shape, weight, d_output, d_input);
  } else {
    scatter(shape, weight, d_output, d_input);
  }
  d_input.fill_borders();
  const Tensor& narrow = shape.transposed ? input : d_output;
  const Tensor& wide = shape.transposed ? d_output : input;
  for_each_value(narrow, [&](int a, int y, int x) {
    for_each_tap(shape, wide, a, y, x, [&](std::size_t w, int b, int row, int column) {
      d_weight[w] += narrow.at(a, y, x) * wide.at(b, row, column);
    });
  });
  if (d_bias.empty()) return;
  for_each_value(d_output, [&](int o, int y, int x) { d_bias[o] += d_output.at(o, y, x); });
}

}  // namespace hqslam::nn
