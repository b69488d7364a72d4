#include "run/report_page.h"
#include "testing.h"
#include "tools/example_run.h"

namespace hqslam::tools {
TEST_CASE("a scan of a view has the pose of a neighbour, to which the motion is known") {
  SlamRun run = example_run(4);
  for (std::size_t pose = 0; pose < 4; ++pose) run.kept_scans.push_back({pose, {7}, {0.0F}});
  std::fill(run.segment_of_scan.begin() + 3, run.segment_of_scan.end(), 1);
  const TurningView view = view_of(run);
  REQUIRE(view.drive.scans.size() == 4);
  CHECK(view.drive.scans[1].name == "scan 0, 0.1 s");
  CHECK(view.drive.scans[1].range[0] == 7);
  CHECK(view.drive.scans[1].T_map_sensor.translation().x() == 1.0);
  const auto checks = [&](std::size_t scan, double other_x_m, double other_s) {
    CHECK(view.drive.scans[scan].T_map_other.translation().x() == other_x_m);
    CHECK(view.drive.scans[scan].other_s == doctest::Approx(other_s));
  };
  checks(1, 2.0, 0.1);
  checks(2, 1.0, -0.1);
  checks(3, 3.0, 0.0);
  run.submap_of_scan = run.segment_of_scan;
  CHECK(view_of(run).drive.scans.size() == 3);
}

TEST_CASE("the path ends where the relative pose is unknown, and other submaps are not shown") {
  SlamRun run = example_run(30);
  run.loops.push_back({slam::LoopStatus::kClosed, 1, 20, 2, 0.5});
  CHECK(view_of(run).paths[0].pieces_m.size() == 1);
  CHECK(view_of(run).loops_m.size() == 1);
  std::fill(run.segment_of_scan.begin() + 10, run.segment_of_scan.end(), 1);
  const TurningView joined = view_of(run);
  REQUIRE(joined.paths[0].pieces_m.size() == 2);
  CHECK(joined.paths[0].pieces_m[0].size() == 10);
  run.submap_of_scan = run.segment_of_scan;
  const TurningView parted = view_of(run);
  CHECK(parted.paths[0].pieces_m.size() == 1);
  CHECK(parted.loops_m.empty());
}

TEST_CASE("the dense map comes first, with its confidence") {
  const SlamRun run = example_run(3);
  DenseMapRun map;
  map.points = {{{1.0F, 2.0F, 3.0F}, 0.7F, 2}};
  const TurningView view = view_of(run, &map);
  REQUIRE(view.clouds.size() == 2);
  CHECK(view.clouds[0].confidence == std::vector<float>{0.7F});
  CHECK(view.clouds[1].points_m.size() == 3);
}

}  // namespace hqslam::tools
