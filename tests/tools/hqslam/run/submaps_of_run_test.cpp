#include "run/dense_map.h"
#include "run/run_summary.h"
#include "tools/example_run.h"
#include "tools/parts_of_text.h"

namespace hqslam::tools {
namespace {

using slam::Status;

/// Ten scans, of which tracking was lost after the third and the fifth; the last part is the
/// largest, and one of its scans was not located.
SlamRun run_of_parts() {
  SlamRun run = example_run(10);
  run.submap_of_scan = {0, 0, 0, 1, 1, 2, 2, 2, 2, 2};
  run.segment_of_scan = run.submap_of_scan;
  run.scans[7].report.mapping_status = Status::kTooFewFeatures;
  run.largest_submap = 2;
  return run;
}

}  // namespace

TEST_CASE("a dense map takes the scans of one part alone, and no motion from one part to another") {
  const ScanPoses poses = poses_of(run_of_parts());
  CHECK(poses.is_located ==
        std::vector<bool>{false, false, false, false, false, true, true, false, true, true});
  CHECK(poses.is_next_known ==
        std::vector<bool>{true, true, false, true, false, true, true, true, true});
  // Nothing is known of the way from a place that was not recognized.
  SlamRun run = example_run(4);
  run.scans[0].report.mapping_status = Status::kNotRecognized;
  CHECK(poses_of(run).is_located == std::vector<bool>{false, true, true, true});
  CHECK(poses_of(run).is_next_known == std::vector<bool>{false, true, true});
}

TEST_CASE("a run of several parts says of which its maps are, and how much is left out") {
  const std::string summary = run_summary(run_of_parts());
  CHECK(holds(summary, "maps: of submap 2 alone, 5 scans; the 5 of other submaps are left out"));
  CHECK_FALSE(holds(run_summary(example_run(3)), "maps:"));
}

}  // namespace hqslam::tools
