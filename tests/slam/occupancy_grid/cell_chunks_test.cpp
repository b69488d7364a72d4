#include "occupancy_grid/cell_chunks.h"

#include "testing.h"

using hqslam::slam::CellChunks;

TEST_CASE("cells on both sides of the origin and far from it are found where they were put") {
  CellChunks<int> cells;
  std::map<std::pair<int, int>, int> expected;
  int next = 0;
  for (const int x : {-5'000'000, -65, -64, -1, 0, 63, 64, 5'000'000}) {
    for (const int y : {-64, -1, 0, 1, 1'000'000}) {
      expected[{x, y}] = ++next;
      cells.find_or_add({x, y}) = next;
    }
  }
  for (const auto& [at, value] : expected) {
    REQUIRE(cells.find({at.first, at.second}) != nullptr);
    CHECK(*cells.find({at.first, at.second}) == value);
  }
  std::map<std::pair<int, int>, int> found;
  cells.for_each([&](const Eigen::Vector2i& at, int value) {
    if (value != 0) found[{at.x(), at.y()}] = value;
  });
  CHECK(found == expected);
  CHECK(cells.find({1'000'000, -64}) == nullptr);
  CHECK(cells.find({2'000'000'000, 0}) == nullptr);
}
