#include "data_consistency.h"

#include <algorithm>

namespace hqslam::nn {

void data_consistency_row(const float* l, const float* z, const float* y, float penalty,
                          int columns, float* h) {
  const float weight_l = 1.0F / (1.0F + 2.0F * penalty);
  const float weight_a = penalty / (1.0F + 2.0F * penalty);  // of Z + Y, not of their mean
  if (l != nullptr) {
    for (int x = 0; x < columns; ++x) h[x] = weight_l * l[x] + weight_a * (z[x] + y[x]);
  } else {
    for (int x = 0; x < columns; ++x) h[x] = 0.5F * (z[x] + y[x]);
  }
}

double data_consistency_gradient_row(const float* l, const float* z, const float* y,
                                     const float* d_h, float penalty, int columns, float* d_a) {
  if (l == nullptr) {
    std::copy_n(d_h, columns, d_a);
    return 0.0;
  }
  const float scale = 1.0F + 2.0F * penalty;
  float sum = 0.0F;
#pragma omp simd reduction(+ : sum)
  for (int x = 0; x < columns; ++x) {
    // d H / d b = 2 (A - L) / (1 + 2 b)^2
    sum += d_h[x] * (z[x] + y[x] - 2.0F * l[x]);
    d_a[x] = d_h[x] * 2.0F * penalty / scale;
  }
  return static_cast<double>(sum) / (static_cast<double>(scale) * scale);
}

}  // namespace hqslam::nn
