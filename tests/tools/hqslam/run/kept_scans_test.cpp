#include "run/kept_scans.h"

#include "testing.h"

namespace hqslam::tools {
namespace {

/// Ranges that rise by 1 m from column to column, times by 1 ms; no return in the first row's
/// first column.
OrganizedCloud example_cloud(int rows, int columns) {
  OrganizedCloud cloud(rows, columns);
  cloud.time_offset_s.resize(cloud.range_m.size());
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const std::size_t pixel = cloud.index(row, column);
      cloud.range_m[pixel] = 1.0F + static_cast<float>(column % 1000);
      cloud.time_offset_s[pixel] = 1e-3F * static_cast<float>(column);
    }
  }
  cloud.range_m[0] = 0.0F;
  return cloud;
}

std::vector<KeptScan> kept_of(std::size_t scans, int rows, int columns) {
  KeptScans kept;
  const OrganizedCloud cloud = example_cloud(rows, columns);
  for (std::size_t pose = 0; pose < scans; ++pose) kept.offer(pose, cloud);
  return kept.take();
}

}  // namespace

TEST_CASE("of a short drive every pixel of every scan is kept, to a centimetre") {
  const std::vector<KeptScan> kept = kept_of(5, 2, 400);
  REQUIRE(kept.size() == 5);
  CHECK(kept[3].pose == 3);
  REQUIRE(kept[3].range.size() == 800);
  CHECK(kept[3].range[0] == 0);
  CHECK(kept[3].range[1] == 100);
  CHECK(kept[3].range[400] == 50);
  REQUIRE(kept[3].time_offset_s.size() == 400);
  CHECK(kept[3].time_offset_s[0] == 0.0F);  // of the second row
  CHECK(kept[3].time_offset_s[399] == doctest::Approx(0.399));
  OrganizedCloud corrected = example_cloud(1, 2);
  corrected.time_offset_s.clear();
  KeptScans scans;
  scans.offer(0, corrected);
  CHECK(std::isnan(scans.take()[0].time_offset_s[1]));
}

TEST_CASE("of a long drive fewer columns are kept, then fewer scans, evenly over all of it") {
  const std::vector<KeptScan> columns = kept_of(700, 40, 1001);
  CHECK(columns.size() == 700);
  CHECK(columns[0].range.size() == 40 * 501);
  CHECK(columns[0].range[501 + 2] == 250);  // of column 4
  CHECK(columns[0].range == columns[699].range);
  CHECK(columns[0].time_offset_s == columns[699].time_offset_s);
  const std::vector<KeptScan> scans = kept_of(3000, 64, 1800);
  CHECK(scans[0].time_offset_s.size() == 225);
  CHECK(scans.size() * scans[0].range.size() <= KeptScans::kMostPixels);
  CHECK(scans.size() * scans[0].range.size() > KeptScans::kMostPixels / 3);
  CHECK(scans.front().pose == 0);
  for (std::size_t i = 1; i < scans.size(); ++i) CHECK(scans[i].pose == scans[1].pose * i);
  CHECK(scans.back().pose + scans[1].pose >= 3000);
}

}  // namespace hqslam::tools
