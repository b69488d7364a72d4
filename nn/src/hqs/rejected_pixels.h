#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include "../tiles.h"

namespace hqslam::nn {

/// Calls visit(channel, first, count, mask) for all pixels of a row of tiles, a part of a channel
/// at a time: mask[i] is not 0 where the filter rejected the pixel in column first + i. rejected:
/// of the image, its rows `columns` long, not 0 where a pixel is rejected.
template <typename Visit>
void for_each_mask(const std::vector<std::uint8_t>& rejected, TileSize tile, int columns, int row,
                   const Visit& visit) {
  constexpr int kMostPixels = 64;
  std::array<std::uint32_t, kMostPixels> mask;
  for (int channel = 0; channel < tile.pixels(); ++channel) {
    const int image_row = row * tile.rows + channel / tile.columns;
    const std::uint8_t* from = rejected.data() + static_cast<std::size_t>(image_row) * columns;
    const int column = channel % tile.columns;
    for (int first = 0; first < columns / tile.columns; first += kMostPixels) {
      const int count = std::min(kMostPixels, columns / tile.columns - first);
      if (tile.columns == 4) {  // the usual size: the bytes of a tile's row as a number
        for (int i = 0; i < count; ++i) {
          std::uint32_t tile_row = 0;
          std::memcpy(&tile_row, from + 4 * (first + i), 4);
          mask[i] = tile_row & (0xFFU << (8 * column));
        }
      } else {
        for (int i = 0; i < count; ++i) mask[i] = from[(first + i) * tile.columns + column];
      }
      visit(channel, first, count, mask.data());
    }
  }
}

}  // namespace hqslam::nn
