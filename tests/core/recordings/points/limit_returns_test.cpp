#include "points/limit_returns.h"

#include "made_scans.h"
#include "testing.h"

using namespace hqslam::recordings;

namespace {

/// A scan of 16 x 100 pixels, of which the first `at_limit` are at `limit_m`, each `step_m` farther
/// than the one before, and the others between 5 and 21 m; and the warnings.
std::pair<RecordedScan, std::vector<std::string>> read_limit(int at_limit, float limit_m,
                                                             float step_m = 0.0F) {
  RecordedScan made;
  made.cloud = OrganizedCloud(16, 100);
  for (int i = 0; i < 1600; ++i) {
    const auto at = static_cast<float>(i);
    made.cloud.range_m[i] = i < at_limit ? limit_m + step_m * at : 5.0F + 0.01F * at;
  }
  made.counts.kept = 1600;
  const auto source =
      without_limit_returns(std::make_unique<MadeScans>(1, [&](std::size_t) { return made; }));
  RecordedScan scan = *source->next();
  return {scan, source->warnings()};
}

}  // namespace

TEST_CASE("pixels without a return that hold the largest range are taken out, and counted") {
  for (const float limit_m : {65.535F, 90.0F, 120.0F}) {
    const auto [scan, warnings] = read_limit(160, limit_m);
    CHECK(scan.counts.kept == 1440);
    CHECK(scan.counts.out_of_range == 160);
    CHECK(scan.cloud.range_m[159] == 0.0F);
    CHECK(scan.cloud.range_m[160] == 6.6F);
    CHECK(one_line_with(warnings, "160 of 1600 returns", "taken as none"));
  }
}

TEST_CASE("what a scan measures at its farthest stays") {
  const auto stays = [](const auto& found) { return found.second.empty(); };
  CHECK(stays(read_limit(16, 90.0F)));           // 1 % of the returns
  CHECK(stays(read_limit(160, 60.0F, 0.001F)));  // within 8 cm: a wall
  CHECK(stays(read_limit(100, 90.0F)));          // a ring on flat ground
  CHECK(stays(read_limit(1600, 10.0F)));         // of one range alone
}
