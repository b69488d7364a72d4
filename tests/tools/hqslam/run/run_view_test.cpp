#include <doctest/doctest.h>

#include "run/report_page.h"
#include "tools/example_run.h"

namespace hqslam::tools {
namespace {

/// A return 10 m ahead in every row, the second of two columns half a scan later.
OrganizedCloud two_columns(int rows) {
  OrganizedCloud cloud(rows, 2);
  cloud.time_offset_s.resize(cloud.range_m.size());
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < 2; ++column) {
      const std::size_t pixel = cloud.index(row, column);
      cloud.points_m[pixel] = {10.0F, 0.0F, 0.1F * static_cast<float>(row)};
      cloud.range_m[pixel] = 10.0F;
      cloud.time_offset_s[pixel] = 0.05F * static_cast<float>(column);
    }
  }
  return cloud;
}

}  // namespace

TEST_CASE("of a drive of any length some scans are kept, evenly from its beginning on") {
  KeptScans scans;
  const OrganizedCloud cloud = two_columns(1);
  for (std::size_t pose = 0; pose < 5000; ++pose) scans.offer(pose, cloud);
  const std::vector<KeptScan> kept = scans.take();
  CHECK(kept.size() <= KeptScans::kMost);
  CHECK(kept.size() > KeptScans::kMost / 3);
  CHECK(kept.front().pose == 0);
  for (std::size_t i = 1; i < kept.size(); ++i) {
    CHECK(kept[i].pose - kept[i - 1].pose == kept[1].pose);
  }
  CHECK(kept.back().pose + kept[1].pose >= 5000);
}

TEST_CASE("a scan's points are where the sensor was when it saw them, measured ones told apart") {
  SlamRun run = example_run(3);
  run.measured_rows = RowSelection{3, 4};
  KeptScans scans;
  for (std::size_t pose = 0; pose < 3; ++pose) scans.offer(pose, two_columns(8));
  run.kept_scans = scans.take();
  const TurningView view = view_of(run);
  REQUIRE(view.scans.size() == 3);
  const ViewScan& scan = view.scans[1];
  CHECK(scan.name == "scan 0, 0.1 s");
  REQUIRE(scan.measured.points_m.size() == 4);
  CHECK(scan.upsampled.points_m.size() == 12);
  CHECK(scan.measured.points_m[0].isApprox(Eigen::Vector3f(11.0F, 0.0F, 0.3F)));
  CHECK(scan.measured.points_m[2].isApprox(Eigen::Vector3f(11.5F, 0.0F, 0.3F), 1e-3F));
  run.measured_rows.reset();
  CHECK(view_of(run).scans[1].upsampled.points_m.empty());
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
