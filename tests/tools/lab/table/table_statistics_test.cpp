#include "table/table_statistics.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "table/table_report.h"
#include "tools/parts_of_text.h"

namespace hqslam::tools {
namespace {

Estimate mean_of(const std::vector<double>& values) {
  return bootstrap(values.size(), [&](const std::vector<std::size_t>& members) {
    double sum = 0.0;
    for (const std::size_t member : members) sum += values[member];
    return sum / static_cast<double>(members.size());
  });
}

}  // namespace

TEST_CASE("a sample of equal values has no doubt") {
  const Estimate estimate = mean_of({3.0, 3.0, 3.0, 3.0});
  CHECK(estimate.value == 3.0);
  CHECK(estimate.low == 3.0);
  CHECK(estimate.high == 3.0);
}

// Of two members 0 and 1 a quarter of the draws has mean 0, a quarter 1.
TEST_CASE("two members that differ span the whole interval") {
  const Estimate estimate = mean_of({0.0, 1.0});
  CHECK(estimate.value == 0.5);
  CHECK(estimate.low == 0.0);
  CHECK(estimate.high == 1.0);
}

// The mean of n draws has the deviation s / sqrt(n); its distribution is near the normal one.
TEST_CASE("the interval of a mean is that of the normal distribution, where there are many") {
  std::vector<double> values;
  for (int i = 0; i < 400; ++i) values.push_back(i % 2 == 0 ? 1.0 : -1.0);
  const Estimate estimate = mean_of(values);
  CHECK(estimate.low == doctest::Approx(-1.96 / 20.0).epsilon(0.06));
  CHECK(estimate.high == doctest::Approx(1.96 / 20.0).epsilon(0.06));
}

TEST_CASE("the interval is the same in every run") {
  CHECK(mean_of({1.0, 2.0, 4.0, 8.0}).low == mean_of({1.0, 2.0, 4.0, 8.0}).low);
}

TEST_CASE("one member, or a figure that most draws do not have, has no interval") {
  const Estimate single = mean_of({2.0});
  CHECK(single.value == 2.0);
  CHECK(std::isnan(single.low));
  const Estimate seldom = bootstrap(3, [](const std::vector<std::size_t>& members) {
    const bool all = members == std::vector<std::size_t>{0, 1, 2};
    return all ? 1.0 : std::numeric_limits<double>::quiet_NaN();
  });
  CHECK(seldom.value == 1.0);
  CHECK(std::isnan(seldom.high));
}

namespace {

constexpr int kScans = 300;

/// 300 poses a metre apart along x, `scale` times that, with a jump aside before scan `jump`.
Trajectory straight_drive(double scale, int jump = kScans) {
  Trajectory trajectory;
  for (int i = 0; i < kScans; ++i) {
    StampedPose pose;
    pose.stamp_s = 0.1 * i;
    pose.T_map_sensor.translation() = Eigen::Vector3d(scale * i, i >= jump ? 0.5 : 0.0, 0.0);
    trajectory.push_back(pose);
  }
  return trajectory;
}

TableResult result_of(const TableMethod& method, const Trajectory& trajectory) {
  TableResult result;
  result.method = method;
  result.settings.scans = kScans;
  result.settings.loop_closing = false;
  result.trajectory[kLoopClosingOff] = trajectory;
  result.timings.slam[kLoopClosingOff].total_s = 3.0;
  return result;
}

const std::vector<TableMethod> kMethods = {table_methods()[0], table_methods()[2],
                                           table_methods().back()};

/// A drive of that kind from that seed, on which kMethods drove these trajectories.
DriveFigures drive_of(const std::string& kind, std::uint64_t seed,
                      const std::vector<Trajectory>& trajectories, const Trajectory& truth) {
  TableDrive drive;
  drive.simulated = sim::DriveSpec();
  drive.simulated->name = kind;
  drive.simulated->seed = seed;
  std::vector<TableResult> results;
  for (std::size_t i = 0; i < trajectories.size(); ++i) {
    results.push_back(result_of(kMethods[i], trajectories[i]));
  }
  return drive_figures(drive, "os1-64", results, TrajectoryFile{"truth.tum", truth, true});
}

/// LiDAR-16 drifts by 2.5 % and 2 %, linear by 2 % and 1 %, LiDAR-64 by 1 % and 0.5 %, on a drive
/// each of two kinds; on the second LiDAR-16 slips once.
std::vector<DriveFigures> example_drives() {
  const Trajectory truth = straight_drive(1.0);
  return {
      drive_of("town", 4, {straight_drive(1.025), straight_drive(1.02), straight_drive(1.01)},
               truth),
      drive_of("<hills>", 5,
               {straight_drive(1.02, 150), straight_drive(1.01), straight_drive(1.005)}, truth)};
}

/// Paired with linear.
TableSample sample_with(const std::vector<DriveFigures>& drives) {
  TablePlan plan;
  plan.methods.assign(drives.front().methods.size(), {});
  plan.against = 1;
  return sample_of(drives, plan);
}

TableSample example_sample() {
  static const std::vector<DriveFigures> drives = example_drives();
  return sample_with(drives);
}

std::optional<Estimate> estimate(const TableSample& sample, std::size_t method,
                                 const std::string& key) {
  for (const auto* columns : {&summary_columns(), &pair_columns()}) {
    for (const StatisticsColumn& column : *columns) {
      if (column.key != nullptr && column.key == key) return column.of(sample, method);
    }
  }
  FAIL("no column " << key);
  return std::nullopt;
}

}  // namespace

TEST_CASE("a drive has drift, slips, position error and times of every method") {
  const TableSample sample = example_sample();
  const DriveFigures& hills = *sample.drives[1];
  CHECK(hills.kind == "<hills>");
  CHECK(hills.seed == 5);
  CHECK(path_m(hills) == doctest::Approx(299.0));
  REQUIRE(hills.methods.size() == 3);
  CHECK(hills.methods[0].slips.size() == 1);
  CHECK(hills.methods[0].slam_ms() == doctest::Approx(10.0));
  CHECK(drift(errors_of(hills, 1).pieces).translation_percent == doctest::Approx(1.0));
  // Aligned by its centre, a line that is 1 % long is off by 1 % of the distance from there: of
  // positions 0 to 299 the deviation is sqrt((300^2 - 1) / 12).
  CHECK(errors_of(hills, 1).ape_rmse_m() ==
        doctest::Approx(0.01 * std::sqrt((300.0 * 300.0 - 1.0) / 12.0)));
}

TEST_CASE(
    "a drive whose stamps are not the truth's, or that lacks a method, is not in the sample") {
  Trajectory later = straight_drive(1.0);
  for (StampedPose& pose : later) pose.stamp_s += 1000.0;
  const Trajectory truth = straight_drive(1.0);
  CHECK(sample_with({drive_of("town", 1, {later}, truth)}).drives.empty());
  const std::vector<DriveFigures> drives = {drive_of("town", 1, {truth, truth}, truth),
                                            drive_of("town", 2, {truth}, truth)};
  CHECK(sample_with(drives).drives == std::vector<const DriveFigures*>{&drives.front()});
}

TEST_CASE("the truth of a longer drive is cut where the scans end") {
  Trajectory half = straight_drive(1.0);
  half.resize(200);
  CHECK(path_m(drive_of("town", 1, {half}, straight_drive(1.0))) == doctest::Approx(199.0));
}

TEST_CASE("a summary is the mean over drives, slips are per 100 km of all of them") {
  const TableSample sample = example_sample();
  // On the second drive half of the 200 pieces hold the jump: sqrt(2^2 + 0.5^2) % instead of 2 %.
  const double second = 0.5 * (2.0 + std::sqrt(4.25));
  CHECK(estimate(sample, 0, "drift_percent")->value == doctest::Approx((2.5 + second) / 2.0));
  CHECK(estimate(sample, 0, "drift_percent_no_slip")->value == doctest::Approx(2.25));
  CHECK(slips_of(sample, 0) == 1);
  CHECK(estimate(sample, 0, "slips_per_100_km")->value == doctest::Approx(1e5 / 598.0));
  CHECK(estimate(sample, 0, "slips_per_100_km")->low == 0.0);
  CHECK(slam_ms_of(sample, 0) == doctest::Approx(10.0));
  CHECK(estimate(sample, 2, "drift_percent")->value == doctest::Approx(0.75));
}

TEST_CASE("pairs are differences and ratios drive by drive, and the share of the gap closed") {
  const TableSample sample = example_sample();
  const auto value = [&](std::size_t method, const char* key) {
    return estimate(sample, method, key)->value;
  };
  const Estimate difference = *estimate(sample, 2, "drift_difference_percent");
  CHECK(difference.value == doctest::Approx(-0.75));
  CHECK(difference.low == doctest::Approx(-1.0));
  CHECK(difference.high == doctest::Approx(-0.5));
  CHECK(value(2, "drift_ratio") == doctest::Approx(0.5));
  CHECK(value(2, "gap_closed") == doctest::Approx(1.0));
  CHECK(value(0, "drift_ratio_no_slip") == doctest::Approx(1.5));
  CHECK(value(0, "slips_difference_per_100_km") == doctest::Approx(1e5 / 598.0));
  CHECK(value(0, "gap_closed") == doctest::Approx(0.0));
  const TableSample town = of_kind(sample, "town");
  CHECK(estimate(town, 1, "gap_closed")->value == doctest::Approx(1.0 / 3.0));
  CHECK(estimate(town, 1, "drift_ratio")->value == doctest::Approx(1.0));
}

TEST_CASE("without LiDAR-16 or LiDAR-64 there is no gap to close") {
  std::vector<DriveFigures> drives = example_drives();
  for (DriveFigures& drive : drives) drive.methods.pop_back();
  CHECK_FALSE(estimate(sample_with(drives), 1, "gap_closed"));
}

TEST_CASE("a drive shorter than a piece has slips but no drift, and does not spoil the mean") {
  std::vector<DriveFigures> drives = example_drives();
  Trajectory shorter = straight_drive(1.0);
  shorter.resize(50);
  drives.push_back(drive_of("town", 9, {shorter, shorter, shorter}, straight_drive(1.0)));
  const TableSample sample = sample_with(drives);
  CHECK(sample.drives.size() == 3);
  CHECK(estimate(sample, 1, "drift_percent")->value == doctest::Approx(1.5));
}

TEST_CASE("the texts have a row per method and a part per drive, and need no other file") {
  const TableSample sample = example_sample();
  const TableReport report = statistics_report(sample);
  REQUIRE(report.parts.size() == 3);
  const TextTable& summary = report.parts[0].tables[0];
  REQUIRE(summary.rows.size() == 3);
  CHECK(summary.rows[2][1] == "0.7500 [0.5000, 1.0000]");
  CHECK(summary.rows[0][4] == "1");
  const TextTable& pairs = report.parts[0].tables[1];
  CHECK(pairs.title == "Drive by drive against linear");
  CHECK(pairs.rows[1][1] == "-");
  CHECK(pairs.rows[2][2] == "0.50 [0.50, 0.50]");
  for (const TextTable& text : {summary, pairs}) {
    for (const auto& row : text.rows) CHECK(row.size() == text.columns.size());
  }
  const std::string markdown = markdown_of(report);
  CHECK(missing(markdown, {"## All drives", "## town", "## <hills>", "seeds 4", "| LiDAR-64 |"}) ==
        "");
  const nlohmann::ordered_json part = page_data(report)["parts"][0];
  CHECK(part["paired_with"] == "linear");
  REQUIRE(part["paired_drifts"].size() == 2);
  CHECK(part["paired_drifts"][1]["name"] == "LiDAR-64");
  CHECK(part["paired_drifts"][1]["dots"].size() == part["paired_drifts"][0]["dots"].size());
  CHECK(part["paired_drifts"][1]["mean"].get<double>() == doctest::Approx(-0.75));
}

TEST_CASE("the JSON holds every summary and every drive, null where there is no interval") {
  const nlohmann::json json = nlohmann::json::parse(statistics_json(parts_of(example_sample())));
  CHECK(json["against"] == "linear");
  CHECK(json["methods"][2]["all"]["drift_percent"]["value"].get<double>() == doctest::Approx(0.75));
  CHECK(json["methods"][2]["town"]["drift_percent"]["low"].is_null());
  CHECK(json["drives"][1]["methods"]["rows-16"]["slips"][0]["first_scan"] == 140);
}

}  // namespace hqslam::tools
