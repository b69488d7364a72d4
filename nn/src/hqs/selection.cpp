#include "selection.h"

#include "../kernels/row_kernels.h"

namespace hqslam::nn {

void select_row(const Candidates& candidates, const Tensor& h, TileSize tile,
                InstructionSet instruction_set, int row, float* scores, std::int64_t channel_stride,
                Tensor& z) {
  const kernels::RowKernels& kernels = kernels::row_kernels(instruction_set);
  const std::int64_t group_stride = tile.pixels() * channel_stride;
  for (int channel = 0; channel < tile.pixels(); ++channel) {
    float* of_channel = scores + channel * channel_stride;
    kernels.select({.gain = kSelectionGain,
                    .score_above = of_channel,
                    .score_below = of_channel + group_stride,
                    .score_here = of_channel + 2 * group_stride,
                    .score_nothing = of_channel + 3 * group_stride,
                    .residual = of_channel + 4 * group_stride,
                    .above = candidates.above.row(channel, row),
                    .below = candidates.below.row(channel, row),
                    .here = h.row(channel, row),
                    .z = z.row(channel, row),
                    .columns = z.columns()});
  }
}

void select(const Candidates& candidates, const Tensor& h, TileSize tile,
            InstructionSet instruction_set, Tensor& scores, Tensor& z) {
#pragma omp for schedule(static)
  for (int row = 0; row < z.rows(); ++row) {
    select_row(candidates, h, tile, instruction_set, row, scores.row(0, row),
               scores.channel_stride(), z);
  }
}

void select_backward(const Candidates& candidates, const Tensor& h, TileSize tile,
                     const Tensor& weights, const Tensor& d_z, Tensor& d_scores, Tensor& d_h) {
  const int pixels = tile.pixels();
  for (int row = 0; row < d_z.rows(); ++row) {
    for (int channel = 0; channel < pixels; ++channel) {
      const float* gradient = d_z.row(channel, row);
      const float* candidate[3] = {candidates.above.row(channel, row),
                                   candidates.below.row(channel, row), h.row(channel, row)};
      const float* weight[4];
      float* d_score[4];
      for (int group = 0; group < 4; ++group) {
        weight[group] = weights.row(channel + group * pixels, row);
        d_score[group] = d_scores.row(channel + group * pixels, row);
      }
      float* d_residual = d_scores.row(channel + 4 * pixels, row);
      float* d_here = d_h.row(channel, row);
#pragma omp simd  // d_h may be d_z itself: each value is read before it is written
      for (int x = 0; x < d_z.columns(); ++x) {
        const float mean = weight[0][x] * candidate[0][x] + weight[1][x] * candidate[1][x] +
                           weight[2][x] * candidate[2][x];
        // d softmax_i / d score_j = gain w_i (delta_ij - w_j)
        const float g = kSelectionGain * gradient[x];
        d_score[0][x] = g * weight[0][x] * (candidate[0][x] - mean);
        d_score[1][x] = g * weight[1][x] * (candidate[1][x] - mean);
        d_score[2][x] = g * weight[2][x] * (candidate[2][x] - mean);
        d_score[3][x] = -g * weight[3][x] * mean;
        d_residual[x] = gradient[x];
        d_here[x] = gradient[x] * weight[2][x];
      }
      for (int group = 0; group < kSelectionGroups; ++group) {
        d_scores.fill_border(channel + group * pixels, row);
      }
    }
  }
}

}  // namespace hqslam::nn
