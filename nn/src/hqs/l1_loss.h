#pragma once

#include <optional>

#include "../tensor.h"
#include "../tiles.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::nn {

/// Mean of |Z - truth| over all pixels, "no return" counting as range 0. Rows of the result that
/// get their measured ranges back count as exact (`restored_rows`; nothing: there are none). Writes
/// `share` times the gradient d loss / d Z (0 where the two are equal). Tiles.
double l1_loss(const Tensor& z, const Tensor& truth, TileSize tile,
               std::optional<RowSelection> restored_rows, float share, Tensor& d_z);

}  // namespace hqslam::nn
