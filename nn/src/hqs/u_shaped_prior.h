#pragma once

#include <vector>

#include "prior.h"

namespace hqslam::nn {

/// DU-OR's denoiser: strided convolutions down, transposed convolutions up, on tiles of pixels.
///   encoder.0     3x3, tile.pixels() + memory -> channels[0]
///   encoder.i     3x3, stride 2, channels[i - 1] -> channels[i]
///   bottleneck    3x3, the last channels -> as many
///   decoder.i     2x2 transposed, stride 2, channels[i + 1] -> channels[i], plus encoder.i
///   head          1x1, channels[0] -> 5 tile.pixels() scores and corrections, memory
/// with leaky ReLU after all but the head, whose result goes to `select` (below). The paper
/// gives no sizes.
struct UShapedPriorShape {
  TileSize tile{4, 4};
  std::vector<int> channels{24, 32};
  int memory = 16;
  float negative_slope = 0.0F;
};

/// Throws Error with field, value and constraint.
PriorDescription u_shaped_prior(const UShapedPriorShape& shape);
PriorDescription read_u_shaped_prior(JsonFields& sizes);

/// The end of the U-shaped denoiser. The network scores four candidates for each pixel and adds a
/// correction:
///   Z = w_a above + w_b below + w_h H + r,   (w_a, w_b, w_h, w_0) = softmax(gain scores)
/// w_0 is the weight of "no return". At a depth jump a sum of features and ranges would have to
/// hit the one range or the other exactly, or leave a point hovering between them; a choice only
/// has to be clear.
///
/// scores holds 5 groups of tile.pixels() channels: above, below, here, nothing, r.
inline constexpr int kSelectionGroups = 5;
/// An optimiser of AdamW's kind moves every weight by the same step; scores must become large
/// before a choice is clear, ranges (in units of 80 m) stay below 1.
inline constexpr float kSelectionGain = 4.0F;

/// One row, by the calling thread alone. scores: groups of channels as above, channel_stride floats
/// apart; in the scores, out the softmax. And Z.
void select_row(const Candidates& candidates, const Tensor& h, TileSize tile,
                InstructionSet instruction_set, int row, float* scores, std::int64_t channel_stride,
                Tensor& z);

/// Some rows, `first_row` and what follows it: as many as d_scores has. weights: what select_row
/// left. d_z: d loss / d Z. Writes d loss / d scores (groups as above, borders filled) and d loss /
/// d H along the direct way through w_h. One thread.
void select_backward(const Candidates& candidates, const Tensor& h, TileSize tile,
                     InstructionSet instruction_set, int first_row, const Tensor& weights,
                     const Tensor& d_z, Tensor& d_scores, Tensor& d_h);

}  // namespace hqslam::nn
