#include "dense_map/voxel_grid.h"

#include "testing.h"

using namespace hqslam::slam;

TEST_CASE("a voxel extends from its index to the next, below zero too; far away there is none") {
  const VoxelGrid grid(0.1);
  CHECK(*grid.voxel_of({0.05, 0.0999, 0.1}) == Eigen::Vector3i(0, 0, 1));
  CHECK(*grid.voxel_of({-0.01, -0.1, -0.11}) == Eigen::Vector3i(-1, -1, -2));
  CHECK_FALSE(grid.voxel_of({std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}));
  CHECK_FALSE(grid.voxel_of({0.0, std::numeric_limits<double>::infinity(), 0.0}));
  CHECK_FALSE(grid.voxel_of({0.0, 0.0, -1e7}));
}

TEST_CASE("voxels are found again however many there are, and those never added are not") {
  VoxelGrid grid(0.1);
  std::map<std::tuple<int, int, int>, std::uint32_t> expected;
  std::mt19937 generator(3);
  const auto random = [&] { return static_cast<int>(generator() % 100) - 50; };
  for (std::uint32_t i = 1; i <= 60000; ++i) {
    const Eigen::Vector3i voxel(random(), random(), random());
    grid.find_or_add(voxel).last_scan = i;
    expected[{voxel.x(), voxel.y(), voxel.z()}] = i;
  }
  CHECK(grid.size() == expected.size());
  for (int x = -51; x <= 50; ++x) {
    for (int y = -51; y <= 50; y += 3) {
      for (int z = -51; z <= 50; z += 2) {
        const auto there = expected.find({x, y, z});
        const Voxel* const found = grid.find({x, y, z});
        REQUIRE((found != nullptr) == (there != expected.end()));
        if (found != nullptr) REQUIRE(found->last_scan == there->second);
      }
    }
  }
}

TEST_CASE("a block hands out its voxels with their indices, in the order of their places") {
  VoxelGrid grid(0.1);
  for (const Eigen::Vector3i& voxel :
       {Eigen::Vector3i(-1, -2, -3), Eigen::Vector3i(-8, -2, -3), Eigen::Vector3i(-1, -8, -8)}) {
    grid.find_or_add(voxel);
  }
  REQUIRE(grid.blocks().size() == 1);
  std::vector<Eigen::Vector3i> seen;
  grid.blocks().front().for_each(
      [&](const Eigen::Vector3i& voxel, const Voxel&) { seen.push_back(voxel); });
  CHECK(seen == std::vector<Eigen::Vector3i>{{-1, -8, -8}, {-8, -2, -3}, {-1, -2, -3}});
}
