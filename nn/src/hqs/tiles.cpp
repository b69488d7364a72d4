#include "tiles.h"

namespace hqslam::nn {

void put_image_row(const float* image_row, TileSize tile, int row, Tensor& tiles) {
  for (int column = 0; column < tile.columns; ++column) {
    float* to = tiles.row(row % tile.rows * tile.columns + column, row / tile.rows);
    const float* from = image_row + column;
    for (int x = 0; x < tiles.columns(); ++x) to[x] = from[x * tile.columns];
  }
}

void take_image_row(const Tensor& tiles, TileSize tile, int row, float* image_row) {
  for (int column = 0; column < tile.columns; ++column) {
    const float* from = tiles.row(row % tile.rows * tile.columns + column, row / tile.rows);
    float* to = image_row + column;
    for (int x = 0; x < tiles.columns(); ++x) to[x * tile.columns] = from[x];
  }
}

void to_tiles(const float* image, TileSize tile, Tensor& tiles) {
  const std::int64_t columns = static_cast<std::int64_t>(tiles.columns()) * tile.columns;
  for (int y = 0; y < tiles.rows(); ++y) {
    for (int row = y * tile.rows; row < (y + 1) * tile.rows; ++row) {
      put_image_row(image + row * columns, tile, row, tiles);
    }
    for (int channel = 0; channel < tile.pixels(); ++channel) tiles.fill_border(channel, y);
  }
}

void from_tiles(const Tensor& tiles, TileSize tile, float* image) {
  const std::int64_t columns = static_cast<std::int64_t>(tiles.columns()) * tile.columns;
  for (int row = 0; row < tiles.rows() * tile.rows; ++row) {
    take_image_row(tiles, tile, row, image + row * columns);
  }
}

}  // namespace hqslam::nn
