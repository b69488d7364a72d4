#include "map/cell_index.h"

#include <doctest/doctest.h>

#include <map>
#include <random>

using hqslam::slam::CellChunks;
using hqslam::slam::CellIndex;

TEST_CASE("cells are found by their coordinates, also those at the borders, and no others") {
  std::mt19937 random(1);
  const auto coordinate = [&] {
    return static_cast<int>(random() % (2U * CellIndex::kRange)) - CellIndex::kRange;
  };
  CellIndex index;
  std::map<std::uint64_t, std::uint32_t> added;
  for (std::uint32_t i = 0; i < 5000; ++i) {
    Eigen::Vector3i cell(coordinate(), coordinate(), coordinate());
    if (i % 7 == 0) cell.x() = i % 2 == 0 ? -CellIndex::kRange : CellIndex::kRange - 1;
    const std::uint64_t key = CellIndex::key_of(cell);
    CHECK(CellIndex::cell_of(key) == cell);
    if (!added.emplace(key, i).second) continue;
    CHECK(index.find(key) == CellIndex::kNone);
    index.add(key, i);
  }
  for (const auto& [key, number] : added) CHECK(index.find(CellIndex::cell_of(key)) == number);
  CHECK(index.find(Eigen::Vector3i(CellIndex::kRange, 0, 0)) == CellIndex::kNone);
  CHECK(index.find(Eigen::Vector3i(0, 0, -CellIndex::kRange - 1)) == CellIndex::kNone);
  index.clear();
  CHECK(index.find(added.begin()->first) == CellIndex::kNone);
}

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
