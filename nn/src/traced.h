#pragma once

#include <string>

#include "hqslam/nn/trace.h"
#include "tensor.h"
#include "tiles.h"

namespace hqslam::nn {

/// Channels `first` to first + channels - 1 (0: all from `first` on) of a tensor, without borders.
TracedTensor traced(std::string name, const Tensor& tensor, int first = 0, int channels = 0);

/// The tile.pixels() channels from `first` on, tiles, as an image of pixels without a unit.
TracedTensor traced_pixels(std::string name, const Tensor& tensor, int first, TileSize tile);

}  // namespace hqslam::nn
