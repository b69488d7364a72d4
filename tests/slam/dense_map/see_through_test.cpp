#include "dense_map/see_through.h"

#include "dense_map/voxel_votes.h"
#include "testing.h"

using namespace hqslam::slam;

namespace {

constexpr double kVoxel_m = 0.1;

/// A grid with one measured point of scan 1.
VoxelGrid grid_with(const Eigen::Vector3d& point_m) {
  VoxelGrid grid(kVoxel_m);
  const Eigen::Vector3i voxel = *grid.voxel_of(point_m);
  vote_for(grid.find_or_add(voxel), point_m / kVoxel_m - voxel.cast<double>(), measured_vote(), 1);
  return grid;
}

int votes_against(const Eigen::Vector3d& point_m, const std::vector<Beam>& beams,
                  double max_range_m = 50.0) {
  VoxelGrid grid = grid_with(point_m);
  vote_against_seen_through(grid, beams, 2, max_range_m);
  return grid.find(*grid.voxel_of(point_m))->times_seen_through;
}

const Eigen::Vector3d kPoint(5.05, 0.05, 0.05);
const Beam kThrough{{0.05, 0.05, 0.05}, {10.05, 0.05, 0.05}};

}  // namespace

TEST_CASE("a beam votes once against a voxel that it crosses, none beyond the largest range") {
  CHECK(votes_against(kPoint, {kThrough}) == 1);
  CHECK(votes_against(kPoint, {kThrough}, 4.0) == 0);
  CHECK(votes_against(kPoint, {}) == 0);
}

TEST_CASE("many beams of one scan are one vote, those of two scans two") {
  CHECK(votes_against(kPoint, {kThrough, kThrough, kThrough}) == 1);
  VoxelGrid grid = grid_with(kPoint);
  vote_against_seen_through(grid, {kThrough}, 2, 50.0);
  vote_against_seen_through(grid, {kThrough}, 3, 50.0);
  CHECK(grid.find(*grid.voxel_of(kPoint))->times_seen_through == 2);
}

TEST_CASE("a beam that ends in the voxel, before it or just behind it does not vote against it") {
  CHECK(votes_against(kPoint, {{kThrough.origin_m, kPoint}}) == 0);
  CHECK(votes_against(kPoint, {{kThrough.origin_m, {4.0, 0.05, 0.05}}}) == 0);
  // The gap for 5.4 m of range is 0.3 m + 0.1 m * 5.4 / 1.5 = 0.66 m; the voxel begins at 5.0 m.
  CHECK(votes_against(kPoint, {{kThrough.origin_m, {5.45, 0.05, 0.05}}}) == 0);
  CHECK(votes_against(kPoint, {{kThrough.origin_m, {6.0, 0.05, 0.05}}}) == 1);
  // Nor does another one of a scan that has a point in the voxel.
  CHECK(votes_against(kPoint, {kThrough, {kThrough.origin_m, kPoint}}) == 0);
}

TEST_CASE("a beam that misses the points of a voxel by more than half of it does not vote") {
  const Beam corner{{0.05, 0.099, 0.099}, {10.05, 0.099, 0.099}};
  CHECK(votes_against({5.05, 0.05, 0.05}, {corner}) == 0);
  CHECK(votes_against({5.05, 0.09, 0.09}, {corner}) == 1);
}

TEST_CASE("beams along a street leave the ground that they end on alone") {
  VoxelGrid grid(kVoxel_m);
  for (int k = 100; k < 400; ++k) {
    vote_for(grid.find_or_add({k, 0, 0}), {0.5, 0.5, 0.5}, measured_vote(), 1);
  }
  std::vector<Beam> beams;
  for (int k = 100; k < 400; k += 10) {
    beams.push_back({{0.0, 0.05, 1.85}, {0.1 * k + 0.05, 0.05, 0.05}});
  }
  vote_against_seen_through(grid, beams, 2, 50.0);
  int votes = 0;
  for (int k = 100; k < 400; ++k) votes += grid.find({k, 0, 0})->times_seen_through;
  CHECK(votes == 0);
}
