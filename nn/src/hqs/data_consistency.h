#pragma once

#include "../tensor.h"
#include "../tiles.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::nn {

/// The step that keeps the image true to what was measured, eq. 10a solved pixel by pixel. With
/// A = (Z + Y) / 2, the mean of the two auxiliaries, and b > 0 the penalty:
///   measured rows:  H = (L + 2 b A) / (1 + 2 b)
///   other rows:     H = A
/// Differs from the paper, whose eq. 7 and 10a have D^T Y where D^T L is meant; D^T D is 0 or 1 on
/// each pixel, so no matrix is inverted.
///
/// All tensors hold tiles of ranges in one unit; only the first tile.pixels() channels count.
struct DataConsistency {
  TileSize tile;
  RowSelection measured_rows;
  float penalty = 0.1F;  ///< b

  /// One row of tiles. l: measured ranges, anything in the other rows. h: result, borders filled.
  void forward_row(const Tensor& l, const Tensor& z, const Tensor& y, int row, Tensor& h) const;

  /// d_h: d loss / d H. Writes d loss / d A to d_a and returns d loss / d b. One thread.
  double backward(const Tensor& l, const Tensor& z, const Tensor& y, const Tensor& d_h,
                  Tensor& d_a) const;
};

}  // namespace hqslam::nn
