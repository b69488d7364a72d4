#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hqslam::nn::reference {

/// channels x rows x columns. Beyond its rows an image is 0; beyond its columns, too, or, as a scan
/// is a circle, it goes on with the other end.
struct Image {
  int channels = 1;
  int rows = 1;
  int columns = 1;
  bool circular = true;
  std::vector<double> values;

  Image(int channels_, int rows_, int columns_, bool circular_ = true)
      : channels(channels_),
        rows(rows_),
        columns(columns_),
        circular(circular_),
        values(static_cast<std::size_t>(channels_) * rows_ * columns_) {}

  double& at(int channel, int row, int column) {
    return values[(static_cast<std::size_t>(channel) * rows + row) * columns + column];
  }
  double at(int channel, int row, int column) const {
    return values[(static_cast<std::size_t>(channel) * rows + row) * columns + column];
  }
  double beyond(int channel, int row, int column) const {
    if (circular) column = (column + columns) % columns;
    const bool inside = row >= 0 && row < rows && column >= 0 && column < columns;
    return inside ? at(channel, row, column) : 0.0;
  }
};

/// One learned array: its shape in PyTorch's layout, its values row-major.
struct Array {
  std::vector<std::int64_t> shape;
  std::span<const double> values;
};

/// A convolution with an odd kernel, padded by half of it:
///   out[o][y][x] = bias[o] + sum over i, r, c of
///                  weight[o][i][r][c] in[i][stride y + r - kernel / 2][stride x + c - kernel / 2]
/// in: i x rows x columns. weight: o x i x kernel x kernel. bias: o; null: none.
/// Returns o x rows / stride x columns / stride.
Image convolution(const Image& in, const Array& weight, const Array* bias, int stride = 1);

/// Its adjoint for a kernel of 2 x 2 and a stride of 2: each pixel becomes four.
///   out[o][y][x] = bias[o] + sum over i of weight[i][o][y mod 2][x mod 2] in[i][y / 2][x / 2]
/// in: i x rows x columns. weight: i x o x 2 x 2. Returns o x 2 rows x 2 columns.
Image transposed_convolution(const Image& in, const Array& weight, const Array& bias);

/// max(v, slope v): slope 0 is ReLU.
Image activated(Image image, double slope);
/// Pixel by pixel, channel by channel.
Image sum(Image a, const Image& b);

}  // namespace hqslam::nn::reference
