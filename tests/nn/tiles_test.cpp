#include "tiles.h"

#include "golden.h"
#include "random_values.h"

namespace hqslam::nn {

TEST_CASE("tiles are PyTorch's pixel_unshuffle, and from_tiles is the way back") {
  const Golden golden("layers");
  const std::vector<float> image = golden.values("tiles.image");
  for (const TileSize tile : {TileSize{4, 4}, TileSize{2, 2}}) {
    Tensor tiles(tile.pixels(), 8 / tile.rows, 24 / tile.columns, ColumnPadding::kCircular);
    to_tiles(image.data(), tile, tiles);
    CHECK(values_of(tiles) == golden.values(tile.rows == 4 ? "tiles.4x4" : "tiles.2x2"));
    CHECK(tiles.at(1, 0, -1) == tiles.at(1, 0, tiles.columns() - 1));
    std::vector<float> back(image.size());
    from_tiles(tiles, tile, back.data());
    CHECK(back == image);
  }
}

TEST_CASE("tiles need not be square, and channels beyond the tile's pixels are left alone") {
  const std::vector<float> image = random_values(5, 6 * 40);
  const TileSize tile{3, 2};
  Tensor tiles(7, 2, 20, ColumnPadding::kCircular);
  tiles.at(6, 1, 3) = 9.0F;
  to_tiles(image.data(), tile, tiles);
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 40; ++x) {
      REQUIRE(tiles.at((y % 3) * 2 + x % 2, y / 3, x / 2) == image[y * 40 + x]);
    }
  }
  CHECK(tiles.at(6, 1, 3) == 9.0F);
}

TEST_CASE("with 4 x 4 tiles rows 3, 7, ... are the channels 12 to 15") {
  for (int channel = 0; channel < 16; ++channel) {
    for (int row = 0; row < 4; ++row)
      CHECK(measured({4, 4}, {3, 4}, channel, row) == (channel >= 12));
  }
}

TEST_CASE("measured says of every pixel what its image row says") {
  for (const RowSelection rows : {RowSelection{3, 4}, RowSelection{0, 1}, RowSelection{5, 3}}) {
    for (const TileSize tile : {TileSize{}, TileSize{2, 4}}) {
      for (int y = 0; y < 12; ++y) {
        for (int x = 0; x < tile.columns; ++x) {
          const bool expected = y >= rows.offset && (y - rows.offset) % rows.stride == 0;
          REQUIRE(measured(tile, rows, (y % tile.rows) * tile.columns + x, y / tile.rows) ==
                  expected);
        }
      }
    }
  }
}

}  // namespace hqslam::nn
