#include "tiles.h"

namespace hqslam::nn {

namespace {

typedef float Four __attribute__((vector_size(16), aligned(4), may_alias));

/// A square of 4 x 4 values, rows for columns.
void transpose(Four (&square)[4]) {
  const Four a = __builtin_shufflevector(square[0], square[1], 0, 4, 1, 5);
  const Four b = __builtin_shufflevector(square[0], square[1], 2, 6, 3, 7);
  const Four c = __builtin_shufflevector(square[2], square[3], 0, 4, 1, 5);
  const Four d = __builtin_shufflevector(square[2], square[3], 2, 6, 3, 7);
  square[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
  square[1] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
  square[2] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
  square[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

Four& four_at(float* values) { return *reinterpret_cast<Four*>(values); }
const Four& four_at(const float* values) { return *reinterpret_cast<const Four*>(values); }

}  // namespace

void put_image_row(const float* image_row, TileSize tile, int row, Tensor& tiles) {
  const int first = row % tile.rows * tile.columns;
  int x = 0;
  if (tile.columns == 4) {  // the usual size
    float* to[4];
    for (int i = 0; i < 4; ++i) to[i] = tiles.row(first + i, row / tile.rows);
    for (; x + 4 <= tiles.columns(); x += 4) {
      Four square[4];
      for (int i = 0; i < 4; ++i) square[i] = four_at(image_row + 4 * (x + i));
      transpose(square);
      for (int i = 0; i < 4; ++i) four_at(to[i] + x) = square[i];
    }
  }
  for (int column = 0; column < tile.columns; ++column) {
    float* to = tiles.row(first + column, row / tile.rows);
    for (int i = x; i < tiles.columns(); ++i) to[i] = image_row[i * tile.columns + column];
  }
}

void take_image_row(const Tensor& tiles, TileSize tile, int row, float* image_row, int first) {
  first += row % tile.rows * tile.columns;
  int x = 0;
  if (tile.columns == 4) {
    const float* from[4];
    for (int i = 0; i < 4; ++i) from[i] = tiles.row(first + i, row / tile.rows);
    for (; x + 4 <= tiles.columns(); x += 4) {
      Four square[4];
      for (int i = 0; i < 4; ++i) square[i] = four_at(from[i] + x);
      transpose(square);
      for (int i = 0; i < 4; ++i) four_at(image_row + 4 * (x + i)) = square[i];
    }
  }
  for (int column = 0; column < tile.columns; ++column) {
    const float* from = tiles.row(first + column, row / tile.rows);
    for (int i = x; i < tiles.columns(); ++i) image_row[i * tile.columns + column] = from[i];
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

void from_tiles(const Tensor& tiles, TileSize tile, float* image, int first) {
  const std::int64_t columns = static_cast<std::int64_t>(tiles.columns()) * tile.columns;
  for (int row = 0; row < tiles.rows() * tile.rows; ++row) {
    take_image_row(tiles, tile, row, image + row * columns, first);
  }
}

}  // namespace hqslam::nn
