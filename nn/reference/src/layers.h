#pragma once

#include "image.h"
#include "parameters.h"

namespace hqslam::nn::reference {

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
