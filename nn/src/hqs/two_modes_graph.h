#pragma once

#include "../convolution_graph.h"
#include "hqslam/nn/hqs/network_description.h"

namespace hqslam::nn {

bool is_last_layer(const TwoModesShape& shape, int layer);
/// Channels of a layer's head: seven outputs of every computed pixel, and the memory for the next.
int two_modes_outputs(const TwoModesShape& shape, int layer);

/// The convolutions of a layer (TwoModesLayerShape). rows x columns: of the tiles.
ConvolutionGraph two_modes_graph(const NetworkDescription& description, int layer, int rows,
                                 int columns, InstructionSet instruction_set, int threads);

}  // namespace hqslam::nn
