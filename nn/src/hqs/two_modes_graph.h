#pragma once

#include <vector>

#include "../convolution_graph.h"
#include "../tiles.h"

namespace hqslam::nn {

/// The denoiser of one layer of DU-Mix, on tiles:
///   encoder.0      3x3 with a bias per row, the input -> channels
///   encoder.1      3x3, stride 2, channels -> lower_channels
///   bottleneck.0   3x3, lower_channels -> as many
///   bottleneck.i   3x3 plus its input, i = 1 to residual_blocks
///   decoder.0      2x2 transposed, stride 2, lower_channels -> channels, plus encoder.0
///   head           1x1, channels -> 7 outputs (two_modes.h) of every computed pixel, memory
/// with leaky ReLU after all but the head.
struct TwoModesLayerShape {
  int channels = 48;
  int lower_channels = 72;
  int residual_blocks = 4;
};
struct TwoModesShape {
  TileSize tile{4, 4};  ///< one measured row in each
  std::vector<TwoModesLayerShape> layers = std::vector<TwoModesLayerShape>(1);
  int memory = 16;  ///< channels that a layer hands to the next beside what it says of the pixels
  float negative_slope = 0.1F;
};

bool is_last_layer(const TwoModesShape& shape, int layer);
/// Channels of a layer's head: seven outputs of every computed pixel, and the memory for the next.
int two_modes_outputs(const TwoModesShape& shape, int layer);

/// The convolutions of a layer (TwoModesLayerShape). rows x columns: of the tiles.
ConvolutionGraph two_modes_graph(const TwoModesShape& shape, int layer, int rows, int columns,
                                 InstructionSet instruction_set, int threads);

}  // namespace hqslam::nn
