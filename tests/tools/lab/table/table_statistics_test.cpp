#include "table/table_statistics.h"

#include "table/table_parts.h"
#include "tools/lab/table/example_drives.h"

namespace hqslam::tools {
namespace {

/// All drives over seeds.
TableSample sample_of(const std::vector<FinishedDrive>& drives) {
  return parts_of(example_plan(true), drives).front().sample;
}

Estimate estimate(const TableSample& sample, std::size_t method, const std::string& key) {
  for (const auto* columns : {&summary_columns(), &pair_columns()}) {
    for (const StatisticsColumn& column : *columns) {
      if (column.key == key) return column.of(sample, method);
    }
  }
  FAIL("no column " << key);
  return {};
}

}  // namespace

TEST_CASE("a summary is the mean over drives, slips are those of all of them") {
  const TableSample sample = sample_of(example_drives());
  // On the second drive half of the 200 pieces hold the jump: sqrt(2^2 + 0.5^2) % instead of 2 %.
  const double second = 0.5 * (2.0 + std::sqrt(4.25));
  CHECK(estimate(sample, 0, "drift_percent").value == doctest::Approx((2.5 + second) / 2.0));
  CHECK(estimate(sample, 0, "drift_percent_no_slip").value == doctest::Approx(2.25));
  CHECK(estimate(sample, 0, "slips").value == 1.0);
  CHECK(estimate(sample, 2, "drift_percent").value == doctest::Approx(0.75));
  // Aligned by its centre, a line that is 1 % long is off by 1 % of the distance from there: of
  // positions 0 to 299 the deviation is sqrt((300^2 - 1) / 12). The means of 1 and 0.5 %.
  CHECK(estimate(sample, 2, "ape_m").value ==
        doctest::Approx(0.0075 * std::sqrt((300.0 * 300.0 - 1.0) / 12.0)));
}

TEST_CASE("pairs are differences and ratios drive by drive, and the share of the gap closed") {
  TableSample sample = sample_of(example_drives());
  const auto value = [&](std::size_t method, const char* key) {
    return estimate(sample, method, key).value;
  };
  const Estimate difference = estimate(sample, 2, "drift_difference_percent");
  CHECK(difference.value == doctest::Approx(-0.75));
  CHECK(difference.low == doctest::Approx(-1.0));
  CHECK(difference.high == doctest::Approx(-0.5));
  CHECK(value(2, "drift_ratio") == doctest::Approx(0.5));
  CHECK(value(2, "gap_closed") == doctest::Approx(1.0));
  CHECK(value(0, "drift_ratio_no_slip") == doctest::Approx(1.5));
  CHECK(value(0, "gap_closed") == doctest::Approx(0.0));
  const TableSample town = of_kind(sample, "town");
  CHECK(estimate(town, 1, "gap_closed").value == doctest::Approx(1.0 / 3.0));
  CHECK(estimate(town, 1, "drift_ratio").value == doctest::Approx(1.0));
  sample.methods.back().name = "another";  // no LiDAR-64: no gap
  CHECK(std::isnan(value(1, "gap_closed")));
}

TEST_CASE("a drive shorter than a piece has slips but no drift, and does not spoil the mean") {
  std::vector<FinishedDrive> drives = example_drives();
  const Trajectory shorter = straight_drive(1.0, 50);
  drives.push_back(finished_drive("town", 9, {shorter, shorter, shorter}, straight_drive(1.0)));
  const TableSample sample = sample_of(drives);
  CHECK(sample.drives.size() == 3);
  CHECK(estimate(sample, 1, "drift_percent").value == doctest::Approx(1.5));
}

}  // namespace hqslam::tools
