#include "l1_loss.h"

#include <cmath>

namespace hqslam::nn {

double l1_loss(const Tensor& z, const Tensor& truth, TileSize tile,
               std::optional<RowSelection> restored_rows, float share, Tensor& d_z) {
  const double pixels = static_cast<double>(tile.pixels()) * z.rows() * z.columns();
  const auto weight = static_cast<float>(share / pixels);
  double sum = 0.0;
  for (int channel = 0; channel < tile.pixels(); ++channel) {
    for (int row = 0; row < z.rows(); ++row) {
      float* gradient = d_z.row(channel, row);
      if (restored_rows && measured(tile, *restored_rows, channel, row)) {
        for (int x = 0; x < z.columns(); ++x) gradient[x] = 0.0F;
        continue;
      }
      const float* z_row = z.row(channel, row);
      const float* truth_row = truth.row(channel, row);
      float row_sum = 0.0F;
#pragma omp simd reduction(+ : row_sum)
      for (int x = 0; x < z.columns(); ++x) {
        const float difference = z_row[x] - truth_row[x];
        row_sum += std::fabs(difference);
        gradient[x] = difference > 0.0F ? weight : (difference < 0.0F ? -weight : 0.0F);
      }
      sum += row_sum;
    }
  }
  return sum / pixels;
}

}  // namespace hqslam::nn
