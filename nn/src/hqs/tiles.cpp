#include "hqslam/nn/hqs/tiles.h"

namespace hqslam::nn {

void to_tiles(const float* image, TileSize tile, Tensor& tiles) {
  const int columns = tiles.columns() * tile.columns;
#pragma omp for schedule(static)
  for (int y = 0; y < tiles.rows(); ++y) {
    for (int channel = 0; channel < tile.pixels(); ++channel) {
      const float* from = image + (y * tile.rows + channel / tile.columns) * columns;
      float* to = tiles.row(channel, y);
      for (int x = 0; x < tiles.columns(); ++x) {
        to[x] = from[x * tile.columns + channel % tile.columns];
      }
      tiles.fill_border(channel, y);
    }
  }
}

void from_tiles(const Tensor& tiles, TileSize tile, float* image) {
  const int columns = tiles.columns() * tile.columns;
#pragma omp for schedule(static)
  for (int y = 0; y < tiles.rows(); ++y) {
    for (int channel = 0; channel < tile.pixels(); ++channel) {
      const float* from = tiles.row(channel, y);
      float* to = image + (y * tile.rows + channel / tile.columns) * columns;
      for (int x = 0; x < tiles.columns(); ++x) {
        to[x * tile.columns + channel % tile.columns] = from[x];
      }
    }
  }
}

}  // namespace hqslam::nn
