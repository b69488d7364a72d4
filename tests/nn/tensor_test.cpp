#include "tensor.h"

#include "golden.h"
#include "tiles.h"

namespace hqslam::nn {
namespace {

Tensor counted(int columns, ColumnPadding padding) {
  Tensor tensor(2, 3, columns, padding, 2);
  for (int c = 0; c < 2; ++c) {
    for (int y = 0; y < 3; ++y) {
      for (int x = 0; x < columns; ++x) {
        tensor.at(c, y, x) = static_cast<float>(10000 * (c + 1) + 1000 * y + x);
      }
    }
  }
  return tensor;
}

}  // namespace

TEST_CASE("a circular tensor goes round in its border columns, however narrow it is") {
  for (const int columns : {1, 5, 15, 16, 17, 32, 40}) {
    CAPTURE(columns);
    Tensor tensor = counted(columns, ColumnPadding::kCircular);
    tensor.fill_borders();
    for (int x = -Tensor::kBorderColumns; x < tensor.padded_columns() + Tensor::kBorderColumns;
         ++x) {
      const int round = (x % columns + columns) % columns;
      REQUIRE(tensor.at(1, 2, x) == static_cast<float>(22000 + round));
    }
  }
}

TEST_CASE("a zero-padded tensor has zeros in its border columns, whatever was left there") {
  Tensor tensor = counted(20, ColumnPadding::kZero);
  for (int x = 20; x < tensor.padded_columns(); ++x) tensor.at(0, 1, x) = 7.0F;
  tensor.fill_borders();
  for (int x = -Tensor::kBorderColumns; x < 0; ++x) REQUIRE(tensor.at(0, 1, x) == 0.0F);
  for (int x = 20; x < tensor.padded_columns() + Tensor::kBorderColumns; ++x) {
    REQUIRE(tensor.at(0, 1, x) == 0.0F);
  }
  CHECK(tensor.at(0, 1, 19) == 11019.0F);
}

TEST_CASE("rows beyond the edge are zero before and after the borders are filled") {
  Tensor tensor = counted(20, ColumnPadding::kCircular);
  tensor.fill_borders();
  for (int c = 0; c < 2; ++c) {
    for (const int y : {-2, -1, 3, 4}) {
      for (int x = -Tensor::kBorderColumns; x < 48; ++x) REQUIRE(tensor.at(c, y, x) == 0.0F);
    }
  }
}

TEST_CASE("every row begins with a cache line, also of a copy") {
  const Tensor tensor = counted(20, ColumnPadding::kCircular);
  const Tensor copy = tensor;
  for (const Tensor* one : {&tensor, &copy}) {
    for (int y = -2; y < 5; ++y) {
      CHECK(reinterpret_cast<std::uintptr_t>(one->row(1, y)) %
                CacheLineFloats::allocator_type::kAlignment ==
            0);
    }
  }
}

TEST_CASE("filling one row's border leaves the other rows alone") {
  Tensor tensor = counted(16, ColumnPadding::kCircular);
  tensor.fill_border(1, 1);
  CHECK(tensor.at(1, 1, -1) == 21015.0F);
  CHECK(tensor.at(1, 0, -1) == 0.0F);
  CHECK(tensor.at(1, 2, -1) == 0.0F);
  CHECK(tensor.at(0, 1, -1) == 0.0F);
}

TEST_CASE("tiles are PyTorch's pixel_unshuffle, and from_tiles is its inverse") {
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

}  // namespace hqslam::nn
