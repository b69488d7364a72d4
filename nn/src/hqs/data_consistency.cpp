#include "data_consistency.h"

namespace hqslam::nn {

void DataConsistency::forward_row(const Tensor& l, const Tensor& z, const Tensor& y, int row,
                                  Tensor& h) const {
  const float weight_l = 1.0F / (1.0F + 2.0F * penalty);
  const float weight_a = penalty / (1.0F + 2.0F * penalty);  // of Z + Y, not of their mean
  for (int channel = 0; channel < tile.pixels(); ++channel) {
    const float* z_row = z.row(channel, row);
    const float* y_row = y.row(channel, row);
    const float* l_row = l.row(channel, row);
    float* h_row = h.row(channel, row);
    if (measured(tile, measured_rows, channel, row)) {
      for (int x = 0; x < h.columns(); ++x) {
        h_row[x] = weight_l * l_row[x] + weight_a * (z_row[x] + y_row[x]);  // eq. 10a
      }
    } else {
      for (int x = 0; x < h.columns(); ++x) h_row[x] = 0.5F * (z_row[x] + y_row[x]);
    }
    h.fill_border(channel, row);
  }
}

double DataConsistency::backward(const Tensor& l, const Tensor& z, const Tensor& y,
                                 const Tensor& d_h, Tensor& d_a) const {
  const float scale = 1.0F + 2.0F * penalty;
  double d_penalty = 0.0;
  for (int channel = 0; channel < tile.pixels(); ++channel) {
    for (int row = 0; row < d_h.rows(); ++row) {
      const float* gradient = d_h.row(channel, row);
      float* d_a_row = d_a.row(channel, row);
      if (!measured(tile, measured_rows, channel, row)) {
        for (int x = 0; x < d_h.columns(); ++x) d_a_row[x] = gradient[x];
        continue;
      }
      const float* l_row = l.row(channel, row);
      const float* z_row = z.row(channel, row);
      const float* y_row = y.row(channel, row);
      float sum = 0.0F;
#pragma omp simd reduction(+ : sum)
      for (int x = 0; x < d_h.columns(); ++x) {
        // d H / d b = 2 (A - L) / (1 + 2 b)^2
        sum += gradient[x] * (z_row[x] + y_row[x] - 2.0F * l_row[x]);
        d_a_row[x] = gradient[x] * 2.0F * penalty / scale;
      }
      d_penalty += static_cast<double>(sum) / (static_cast<double>(scale) * scale);
    }
  }
  return d_penalty;
}

}  // namespace hqslam::nn
