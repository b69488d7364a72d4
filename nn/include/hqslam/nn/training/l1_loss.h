#pragma once

#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/hqs/tiles.h"
#include "hqslam/nn/tensor.h"

namespace hqslam::nn {

/// Mean of |Z - truth| over all pixels, "no return" counting as range 0; measured rows, which the
/// result gets back as they were, count as exact. Writes `share` times the gradient d loss / d Z (0
/// where the two are equal). Tiles.
double l1_loss(const Tensor& z, const Tensor& truth, TileSize tile, RowSelection measured_rows,
               float share, Tensor& d_z);

}  // namespace hqslam::nn
