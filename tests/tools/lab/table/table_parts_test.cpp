#include "table/table_parts.h"

#include "tools/lab/table/example_drives.h"

namespace hqslam::tools {
namespace {

/// LiDAR-16 off by 0.4 m, linear by 0.1 m, LiDAR-64 by 0.05 m the other way.
FinishedDrive bumpy_drive() {
  return finished_drive("block", 1,
                        {bumpy_half_circle(0.4), bumpy_half_circle(0.1), bumpy_half_circle(-0.05)},
                        bumpy_half_circle(0.0));
}

}  // namespace

// Bumps up and down in turn along a long path turn the alignment by next to nothing: each error is
// the bump.
TEST_CASE("a drive is evaluated against the truth and against LiDAR-64, with a map for each") {
  const std::vector<TablePart> parts = parts_of(example_plan(false), {bumpy_drive()});
  REQUIRE(parts.size() == 2);
  CHECK(parts[0].name == "block against the truth");
  const DriveErrors& truth = parts[0].sample.drives.front();
  CHECK(truth.methods[1].ape_rmse_m == doctest::Approx(0.1).epsilon(0.01));
  CHECK(truth.methods[2].ape_rmse_m == doctest::Approx(0.05).epsilon(0.01));
  // 39 steps of 2 * 124 m * sin(pi / 78).
  CHECK(truth.path_m() == doctest::Approx(389.45).epsilon(1e-4));
  CHECK(parts[1].name == "block against LiDAR-64");
  const DriveErrors& all_rows = parts[1].sample.drives.front();
  CHECK(all_rows.methods[1].ape_rmse_m == doctest::Approx(0.15).epsilon(0.01));
  CHECK(all_rows.methods[2].ape_rmse_m == doctest::Approx(0.0));
  const ErrorMap& map = parts[1].map;  // of all methods but the reference
  REQUIRE(map.paths.size() == 2);
  CHECK(map.paths[1].method == "linear");
  CHECK(map.paths[1].error_m.size() == 40);
  CHECK(map.paths[1].rmse_m == doctest::Approx(0.15).epsilon(0.01));
  CHECK(map.paths[1].distance_m.back() == doctest::Approx(389.45).epsilon(1e-4));
}

TEST_CASE("without LiDAR-64 or without the truth the part against it is not there") {
  FinishedDrive drive = bumpy_drive();
  drive.truth.reset();
  CHECK(parts_of(example_plan(false), {drive}).size() == 1);
  drive.trajectories.pop_back();
  TablePlan plan = example_plan(false);
  plan.methods.pop_back();
  CHECK(parts_of(plan, {drive}).empty());
}

TEST_CASE("over seeds drives of a kind are evaluated together, behind all of them") {
  const std::vector<TablePart> parts = parts_of(example_plan(true), example_drives());
  REQUIRE(parts.size() == 3);
  CHECK(parts[0].name == "all");
  CHECK(parts[0].sample.drives.size() == 2);
  CHECK(parts[2].name == "<hills>");
  CHECK(parts[2].sample.drives.front().seed == 5);
  CHECK(parts[2].sample.drives.front().methods[0].slips.size() == 1);
  CHECK(parts_of(example_plan(true), {example_drives().front()}).front().name == "town");
}

TEST_CASE("a drive with a method that cannot be compared is left out") {
  std::vector<FinishedDrive> drives = example_drives();
  for (StampedPose& pose : drives[0].trajectories[1]) pose.stamp_s += 1000.0;
  const std::vector<TablePart> parts = parts_of(example_plan(true), drives);
  REQUIRE(parts.size() == 1);
  CHECK(parts[0].name == "<hills>");
}

TEST_CASE("the path is the reference's, along the poses that were compared") {
  const Trajectory reference = bumpy_half_circle(0.0);
  Trajectory estimate;
  for (std::size_t i = 0; i < reference.size(); i += 2) estimate.push_back(reference[i]);
  // 19 chords of 2 * 124 m * sin(pi / 39).
  CHECK(trajectory_errors(estimate, reference)->path_m == doctest::Approx(379.15).epsilon(1e-4));
  estimate.resize(2);
  CHECK_FALSE(trajectory_errors(estimate, reference));
  CHECK(trajectory_errors(straight_drive(1.0, 200), straight_drive(1.0))->path_m ==
        doctest::Approx(199.0));
}

TEST_CASE("long paths are thinned, each pose with its own error and distance") {
  const Trajectory reference = straight_drive(1.0, 2040);
  const FinishedDrive drive =
      finished_drive("block", 1, {reference, straight_drive(1.01, 2040), reference}, {});
  const ErrorMap map = parts_of(example_plan(false), {drive}).front().map;
  CHECK(map.x_m.size() == 2040 / 3);  // every third pose
  CHECK(map.paths[1].error_m.size() == map.x_m.size());
  CHECK(map.paths[1].distance_m[2] == doctest::Approx(6.0));
  CHECK(map.paths[1].error_m[2] == doctest::Approx(0.01 * (1019.5 - 6.0)).epsilon(1e-3));
}

}  // namespace hqslam::tools
