#pragma once

#include "hqslam/core/sensor_model.h"
#include "tensor.h"

namespace hqslam::nn {

/// An image cut into tiles of rows x columns pixels, each pixel of a tile in a channel of its own
/// (pixel-unshuffle, PyTorch's order): pixel (y, x) is channel (y % rows) columns + x % columns,
/// row y / rows, column x / columns. With 4 x 4 tiles and 16 of 64 rows measured, the measured rows
/// are channels of their own. 1 x 1 is the image as it is.
struct TileSize {
  int rows = 1;
  int columns = 1;
  int pixels() const { return rows * columns; }
  bool operator==(const TileSize&) const = default;
};

/// image: rows x columns, row-major. Fills the first tile.pixels() channels of `tiles`, borders
/// too. By the calling thread alone.
void to_tiles(const float* image, TileSize tile, Tensor& tiles);
/// The inverse, of the channels from `first` on.
void from_tiles(const Tensor& tiles, TileSize tile, float* image, int first = 0);

/// One row of the image, by the calling thread alone; borders are left as they are.
void put_image_row(const float* image_row, TileSize tile, int row, Tensor& tiles);
void take_image_row(const Tensor& tiles, TileSize tile, int row, float* image_row, int first = 0);

/// Whether row `row` of channel `channel` of the tiles holds measured pixels.
inline bool measured(TileSize tile, RowSelection measured_rows, int channel, int row) {
  const int image_row = row * tile.rows + channel / tile.columns;
  return image_row >= measured_rows.offset &&
         (image_row - measured_rows.offset) % measured_rows.stride == 0;
}

}  // namespace hqslam::nn
