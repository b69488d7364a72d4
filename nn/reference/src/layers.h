#pragma once

#include <cstdint>
#include <span>
#include <unsupported/Eigen/CXX11/Tensor>
#include <vector>

#include "hqslam/nn/reference/reference.h"

namespace hqslam::nn::reference {

/// channels x rows x columns, an Eigen tensor of doubles.
using Image = ReferenceTensor::Values;

/// All zero.
Image zeros(std::int64_t channels, std::int64_t rows, std::int64_t columns);

/// What stands beyond the first and the last column. Beyond the first and the last row it is 0.
enum class Beyond {
  kOtherEnd,  ///< a scan is a circle
  kZero,
};
/// A value of the image or beyond its edge.
double value_at(const Image& image, Beyond beyond, int channel, int row, int column);

/// One learned array: its shape in PyTorch's layout, its values row-major.
struct Array {
  std::vector<std::int64_t> shape;
  std::span<const double> values;

  /// The weights of a convolution.
  Eigen::TensorMap<const Eigen::Tensor<double, 4, Eigen::RowMajor>> weights() const {
    return {values.data(), shape[0], shape[1], shape[2], shape[3]};
  }
};

/// A convolution with an odd kernel, padded by half of it:
///   out[o][y][x] = bias[o] + sum over i, r, c of
///                  weight[o][i][r][c] in[i][stride y + r - kernel / 2][stride x + c - kernel / 2]
/// in: i x rows x columns. weight: o x i x kernel x kernel. bias: o; null: none.
/// Returns o x rows / stride x columns / stride.
Image convolution(const Image& in, const Array& weight, const Array* bias, int stride = 1,
                  Beyond beyond = Beyond::kOtherEnd);

/// Its adjoint for a kernel of 2 x 2 and a stride of 2: each pixel becomes four.
///   out[o][y][x] = bias[o] + sum over i of weight[i][o][y mod 2][x mod 2] in[i][y / 2][x / 2]
/// in: i x rows x columns. weight: i x o x 2 x 2. Returns o x 2 rows x 2 columns.
Image transposed_convolution(const Image& in, const Array& weight, const Array& bias);

/// max(v, slope v): slope 0 is ReLU.
Image activated(const Image& image, double slope);

}  // namespace hqslam::nn::reference
