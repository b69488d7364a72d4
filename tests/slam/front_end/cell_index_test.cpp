#include "front_end/cell_index.h"

#include "testing.h"

using hqslam::slam::CellIndex;

TEST_CASE("cells are found by their coordinates, also those at the borders, and no others") {
  std::mt19937 random(1);
  const auto coordinate = [&] {
    return static_cast<int>(random() % (2U * CellIndex::kRange)) - CellIndex::kRange;
  };
  CellIndex index;
  std::map<std::uint64_t, std::uint32_t> added;
  for (int i = 0; i < 5000; ++i) {
    Eigen::Vector3i cell(coordinate(), coordinate(), coordinate());
    if (i % 7 == 0) cell.x() = i % 2 == 0 ? -CellIndex::kRange : CellIndex::kRange - 1;
    const std::uint64_t key = CellIndex::key_of(cell);
    CHECK(CellIndex::cell_of(key) == cell);
    const auto [found, is_new] = added.emplace(key, added.size());
    CHECK((index.find(key) == CellIndex::kNone) == is_new);
    CHECK(index.find_or_add(key) == found->second);
  }
  for (const auto& [key, number] : added) CHECK(index.find(CellIndex::cell_of(key)) == number);
  CHECK(index.find(Eigen::Vector3i(CellIndex::kRange, 0, 0)) == CellIndex::kNone);
  CHECK(index.find(Eigen::Vector3i(0, 0, -CellIndex::kRange - 1)) == CellIndex::kNone);
  index.clear();
  CHECK(index.find(added.begin()->first) == CellIndex::kNone);
}
