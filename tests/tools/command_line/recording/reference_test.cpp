#include "recording/reference.h"

#include "tools/example_run.h"

namespace hqslam::tools {

TEST_CASE("poses without stamps are those of the other file, one by one") {
  TrajectoryFile file;
  file.path = "poses.txt";
  file.poses = example_run(5).trajectory;
  Trajectory other = example_run(5).trajectory;
  other[2].stamp_s = 77.0;
  CHECK(with_stamps_of(file, other)[2].stamp_s == 77.0);
  other.resize(3);
  CHECK(refused_with([&] { with_stamps_of(file, other); }, "poses.txt", "5 poses", "3;"));
  file.has_stamps = true;
  CHECK(with_stamps_of(file, other).size() == 5);
}

TEST_CASE("poses without stamps are those of the scans that were not left out") {
  TrajectoryFile file;
  file.poses = example_run(5).trajectory;
  const Trajectory other = example_run(3).trajectory;
  const Trajectory stamped = with_stamps_of_scans(file, other, {0, 2, 3});
  REQUIRE(stamped.size() == 3);
  for (const auto& [pose, scan] : {std::pair(0, 0), std::pair(1, 2), std::pair(2, 3)}) {
    CHECK(stamped[pose].stamp_s == other[pose].stamp_s);
    CHECK(stamped[pose].T_map_sensor.isApprox(file.poses[scan].T_map_sensor));
  }
  CHECK(with_stamps_of_scans(file, other, {0, 4, 5}).size() == 2);
  file.has_stamps = true;
  CHECK(with_stamps_of_scans(file, other, {0, 2, 3}).size() == 5);
}

TEST_CASE("an estimate in another frame than its reference has no error after alignment") {
  const SlamRun run = example_run(30);
  TrajectoryFile reference = example_reference(run, 0.0);
  const auto comparison = compare_with_reference(run.trajectory, reference).value();
  CHECK(comparison.error.translation_statistics.max < 1e-9);
  CHECK(comparison.reference.size() == 30);
  // Two poses or other stamps are too little to compare.
  CHECK_FALSE(compare_with_reference(example_run(2).trajectory, reference));
  for (StampedPose& pose : reference.poses) pose.stamp_s += 1000.0;
  CHECK_FALSE(compare_with_reference(run.trajectory, reference));
}

}  // namespace hqslam::tools
