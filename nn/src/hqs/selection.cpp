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

void select_backward(const Candidates& candidates, const Tensor& h, TileSize tile,
                     InstructionSet instruction_set, int first_row, const Tensor& weights,
                     const Tensor& d_z, Tensor& d_scores, Tensor& d_h) {
  const kernels::RowKernels& kernels = kernels::row_kernels(instruction_set);
  const int pixels = tile.pixels();
  for (int y = 0; y < d_scores.rows(); ++y) {
    const int row = first_row + y;
    for (int channel = 0; channel < pixels; ++channel) {
      kernels.select_gradient({.gain = kSelectionGain,
                               .weight_above = weights.row(channel, row),
                               .weight_below = weights.row(channel + pixels, row),
                               .weight_here = weights.row(channel + 2 * pixels, row),
                               .weight_nothing = weights.row(channel + 3 * pixels, row),
                               .above = candidates.above.row(channel, row),
                               .below = candidates.below.row(channel, row),
                               .here = h.row(channel, row),
                               .d_z = d_z.row(channel, row),
                               .d_score_above = d_scores.row(channel, y),
                               .d_score_below = d_scores.row(channel + pixels, y),
                               .d_score_here = d_scores.row(channel + 2 * pixels, y),
                               .d_score_nothing = d_scores.row(channel + 3 * pixels, y),
                               .d_residual = d_scores.row(channel + 4 * pixels, y),
                               .d_here = d_h.row(channel, row),
                               .columns = d_z.columns()});
      for (int group = 0; group < kSelectionGroups; ++group) {
        d_scores.fill_border(channel + group * pixels, y);
      }
    }
  }
}

}  // namespace hqslam::nn
