#pragma once

#include "direct_network.h"

namespace hqslam::nn {

/// SRAE, "Simulation-based lidar super-resolution for ground vehicles" (Shan et al., 2020): a U-Net
/// of convolutions with batch norm and ReLU. F filters, every convolution 3 x 3 with zeros beyond
/// the edges:
///   up.i          transposed, strides 2 x 1, F       until there are all rows
///   encoder.0     two convolutions, F
///   encoder.i     average pool 2 x 2, dropout, two convolutions, 2^i F     i = 1 to 4
///   decoder.i     dropout, transposed `up`, stride 2, 2^(3-i) F; beside it encoder.(3-i); two
///                 convolutions, 2^(3-i) F                                  i = 0 to 3
///   head          1 x 1 with ReLU, 1
/// The paper's F is 64.
struct SraeShape {
  int filters = 8;
  float dropout = 0.25F;
  /// The result is the mean over so many passes with dropout; a pixel where their standard
  /// deviation is above largest_deviation times the mean comes out empty. 1: one pass without
  /// dropout.
  int passes = 50;
  float largest_deviation = 0.03F;
};
/// Of the encoder: rows and columns of the whole image are multiples of it.
inline constexpr int kSraeStride = 16;

/// The graph for lifting has batch norm worked into the convolutions, and no gradients; the arrays
/// of both are the same. input: the measured rows; upscaling: how many rows each becomes, a power
/// of 2.
LayerGraph srae_graph(const SraeShape& shape, const TensorShape& input, int upscaling,
                      Purpose purpose, const Engine& engine);

}  // namespace hqslam::nn
