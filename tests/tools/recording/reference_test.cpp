#include "recording/reference.h"

#include <doctest/doctest.h>

#include <utility>

#include "error_message.h"
#include "file_contents.h"
#include "temporary_directory.h"
#include "tools/example_run.h"

namespace hqslam::tools {
namespace {

using hqslam::test::TemporaryDirectory;

}  // namespace

TEST_CASE("a TUM file has stamps and a KITTI file has none") {
  const TemporaryDirectory folder;
  const Trajectory poses = example_run(5).trajectory;
  write_tum(poses, folder.file("a.txt"));
  write_kitti_poses(poses, folder.file("b.txt"));
  CHECK(read_trajectory_file(folder.file("a.txt")).has_stamps);
  CHECK_FALSE(read_trajectory_file(folder.file("b.txt")).has_stamps);
}

TEST_CASE("a comment behind a pose does not take a file's stamps away") {
  const TemporaryDirectory folder;
  const Trajectory poses = example_run(5).trajectory;
  write_tum(poses, folder.file("plain.txt"));
  std::string text = hqslam::test::file_contents(folder.file("plain.txt"));
  text.insert(text.find('\n'), " # the start of the drive");
  hqslam::test::write_file(folder.file("commented.txt"), "# stamp x y z\n" + text);
  const TrajectoryFile file = read_trajectory_file(folder.file("commented.txt"));
  CHECK(file.has_stamps);
  CHECK(file.poses.size() == 5);
}

TEST_CASE("poses without stamps are those of the other file, one by one") {
  TrajectoryFile file;
  file.poses = example_run(5).trajectory;
  Trajectory other = example_run(3).trajectory;
  other[2].stamp_s = 77.0;
  const Trajectory stamped = with_stamps_of(file, other);
  REQUIRE(stamped.size() == 3);
  CHECK(stamped[2].stamp_s == 77.0);
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
  const auto comparison = compare_with_reference(run.trajectory, example_reference(run, 0.0));
  REQUIRE(comparison);
  CHECK(comparison->error.translation_statistics.max < 1e-9);
  CHECK(comparison->reference.size() == 30);
}

TEST_CASE("two poses or other stamps are too little to compare") {
  const SlamRun run = example_run(30);
  TrajectoryFile reference = example_reference(run, 0.0);
  CHECK_FALSE(compare_with_reference(example_run(2).trajectory, reference));
  for (StampedPose& pose : reference.poses) {
    pose.stamp_s += 1000.0;
  }
  CHECK_FALSE(compare_with_reference(run.trajectory, reference));
}

}  // namespace hqslam::tools
