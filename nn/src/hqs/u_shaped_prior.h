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
/// with leaky ReLU after all but the head, whose result goes to `select` (selection.h). The paper
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

}  // namespace hqslam::nn
