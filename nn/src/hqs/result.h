#pragma once

#include "../tensor.h"
#include "../tiles.h"
#include "hqslam/core/range_image.h"
#include "hqslam/nn/network_description.h"

namespace hqslam::nn {

/// The last layer's Z as an image in metres: ranges outside the sensor's limits become "no return",
/// the measured rows are put back. z: tiles. measured: one row per measured row. Called by all
/// threads of a parallel region, they share the work.
void restore_rows(const NetworkDescription& description, TileSize tile, const Tensor& z,
                  const RangeImage& measured, RangeImage& image);

}  // namespace hqslam::nn
