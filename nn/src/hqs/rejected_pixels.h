#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

#include "tiles.h"

namespace hqslam::nn {

/// Calls visit(channel, x) for every rejected pixel of a row of tiles. rejected: of the image, its
/// rows `columns` long, not 0 where a pixel is rejected.
template <typename Visit>
void for_each_rejected(const std::vector<std::uint8_t>& rejected, TileSize tile, int columns,
                       int row, const Visit& visit) {
  const std::uint8_t* mask = rejected.data() + static_cast<std::size_t>(row) * tile.rows * columns;
  for (int y = 0; y < tile.rows; ++y, mask += columns) {
    // Few pixels are rejected: look for them eight at a time.
    for (int begin = 0; begin < columns; begin += 8) {
      const int end = std::min(begin + 8, columns);
      std::uint64_t any = 0;
      std::memcpy(&any, mask + begin, static_cast<std::size_t>(end - begin));
      if (any == 0) continue;
      for (int column = begin; column < end; ++column) {
        if (mask[column] == 0) continue;
        visit(y * tile.columns + column % tile.columns, column / tile.columns);
      }
    }
  }
}

}  // namespace hqslam::nn
