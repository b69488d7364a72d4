// The transforms of Winograd's convolution; included as row_kernels_inl.h is.
// winograd_convolution.h has the formulas.

#include "row_kernels.h"
#include "vector_math_inl.h"

namespace hqslam::nn::kernels {
namespace {

/// B^T x
inline void winograd_differences(const Vector (&x)[4], Vector (&y)[4]) {
  y[0] = x[0] - x[2];
  y[1] = x[1] + x[2];
  y[2] = x[2] - x[1];
  y[3] = x[1] - x[3];
}

void winograd_input(const WinogradInputRow& row) {
  for (int tile = 0; tile < row.tiles; tile += kVectorFloats) {
    Vector half[4][4];  // d B, one row of d after the other
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
      const float* values = row.input[i] + 2 * tile;
      const Vector first = load(values);
      const Vector second = load(values + kVectorFloats);
      const Vector third = load(values + 2);
      const Vector fourth = load(values + 2 + kVectorFloats);
      const Vector columns[4] = {every_second<0>(first, second), every_second<1>(first, second),
                                 every_second<0>(third, fourth), every_second<1>(third, fourth)};
      winograd_differences(columns, half[i]);
    }
#pragma GCC unroll 4
    for (int j = 0; j < 4; ++j) {
      const Vector column[4] = {half[0][j], half[1][j], half[2][j], half[3][j]};
      Vector whole[4];
      winograd_differences(column, whole);
#pragma GCC unroll 4
      for (int i = 0; i < 4; ++i) {
        store(row.transformed + (4 * i + j) * row.place_stride + tile, whole[i]);
      }
    }
  }
}

/// One of the two rows that a row of tiles makes.
inline void winograd_end(const WinogradOutputRow& row, int part, int column, Vector y) {
  const auto at = [column](const float* values) {
    return values == nullptr ? nullptr : values + column;
  };
  store(row.output[part] + column,
        ended(y, at(row.skip[part]), at(row.activated[part]), row.negative_slope));
}

void winograd_output(const WinogradOutputRow& row) {
  const int parts = row.output[1] == nullptr ? 1 : 2;
  for (int tile = 0; tile < row.tiles; tile += kVectorFloats) {
    Vector half[2][4];  // A^T m
#pragma GCC unroll 4
    for (int j = 0; j < 4; ++j) {
      const float* products = row.products + j * row.place_stride + tile;
      const Vector m0 = load(products);
      const Vector m1 = load(products + 4 * row.place_stride);
      const Vector m2 = load(products + 8 * row.place_stride);
      const Vector m3 = load(products + 12 * row.place_stride);
      half[0][j] = m0 + m1 + m2;
      half[1][j] = m1 - m2 - m3;
    }
#pragma GCC unroll 2
    for (int part = 0; part < 2; ++part) {
      if (part == parts) break;
      const Vector* const h = half[part];
      const Vector even = h[0] + h[1] + h[2] + row.bias;
      const Vector odd = h[1] - h[2] - h[3] + row.bias;
      winograd_end(row, part, 2 * tile, alternating<0>(even, odd));
      winograd_end(row, part, 2 * tile + kVectorFloats, alternating<kVectorFloats / 2>(even, odd));
    }
  }
}

/// A x
inline void winograd_spread(Vector x0, Vector x1, Vector (&y)[4]) {
  y[0] = x0;
  y[1] = x0 + x1;
  y[2] = x0 - x1;
  y[3] = -x1;
}

void winograd_gradient(const WinogradGradientRow& row) {
  for (int tile = 0; tile < row.tiles; tile += kVectorFloats) {
    Vector half[2][4];  // d Y A^T, one row of d Y after the other
#pragma GCC unroll 2
    for (int part = 0; part < 2; ++part) {
      if (row.d_output[part] == nullptr) {
        winograd_spread(Vector{}, Vector{}, half[part]);
        continue;
      }
      const Vector first = load(row.d_output[part] + 2 * tile);
      const Vector second = load(row.d_output[part] + 2 * tile + kVectorFloats);
      winograd_spread(every_second<0>(first, second), every_second<1>(first, second), half[part]);
    }
#pragma GCC unroll 4
    for (int j = 0; j < 4; ++j) {
      Vector whole[4];
      winograd_spread(half[0][j], half[1][j], whole);
#pragma GCC unroll 4
      for (int i = 0; i < 4; ++i) {
        store(row.transformed + (4 * i + j) * row.place_stride + tile, whole[i]);
      }
    }
  }
}

}  // namespace
}  // namespace hqslam::nn::kernels
