#pragma once

#include "prior.h"

namespace hqslam::nn {

/// DU-Mix's prior, on tiles that have one measured row each:
///   encoder.0      3x3 with a bias per row, the input -> channels
///   encoder.1      3x3, stride 2, channels -> lower_channels
///   bottleneck.0   3x3, lower_channels -> as many
///   bottleneck.i   3x3 plus its input, i = 1 to residual_blocks
///   decoder.0      2x2 transposed, stride 2, lower_channels -> channels, plus encoder.0
///   head           1x1, channels -> 7 outputs (kernels/two_modes.h) of every computed pixel, 9
///   with
///                  a memory
/// with leaky ReLU after all but the head. The input: (H - ln 20) / 2, where something was
/// measured, and ln above - ln below of the measured rows; with a memory also M minus the start
/// (of a measured pixel minus L) within +-1, and W^2 / (W^2 + 1) - 1/2. Z is the likelier mode, all
/// in y = ln(range in metres); what is known to a centimetre needs no penalty, so b -> 0.
struct TwoModesShape {
  TileSize tile{4, 4};
  int channels = 48;
  int lower_channels = 72;
  int residual_blocks = 4;
  float negative_slope = 0.1F;
  int memory = 16;           ///< between layers, of which there is one: files have it
  bool scan_memory = false;  ///< M and W of earlier scans (RecalledImage) are looked at
};

/// Throws Error with field, value and constraint.
PriorDescription two_modes_prior(const TwoModesShape& shape);
PriorDescription read_two_modes_prior(JsonFields& sizes);

}  // namespace hqslam::nn
