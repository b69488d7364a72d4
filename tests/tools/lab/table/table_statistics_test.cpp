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

TableResult result_of(const Trajectory& trajectory) {
  TableResult result;
  result.settings.scans = kScans;
  result.settings.loop_closing = false;
  result.trajectory[kLoopClosingOff] = trajectory;
  result.timings.slam[kLoopClosingOff].total_s = 3.0;
  return result;
}

const std::vector<TableMethod> kMethods = {table_methods()[0], table_methods()[2],
                                           table_methods().back()};

/// A drive of that name from that seed, on which each method did as its result says.
std::optional<DriveSample> drive_of(const std::string& name, std::uint64_t seed,
                                    const std::vector<TableResult>& results,
                                    const Trajectory& truth) {
  TableDrive drive;
  drive.simulated = sim::DriveSpec();
  drive.simulated->name = name;
  drive.simulated->seed = seed;
  const std::vector<TableMethod> methods(
      kMethods.begin(), kMethods.begin() + static_cast<std::ptrdiff_t>(results.size()));
  return drive_sample(
      drive_figures(drive, "os1-64", methods, results, TrajectoryFile{"truth.tum", truth, true}),
      methods);
}

/// LiDAR-16 drifts by 2.5 % and 2 %, linear by 2 % and 1 %, LiDAR-64 by 1 % and 0.5 %, on a drive
/// each of two names; on the second LiDAR-16 slips once.
TableSample example_sample() {
  TableSample sample{kMethods, 1, {}};
  const Trajectory truth = straight_drive(1.0);
  sample.drives.push_back(
      *drive_of("town", 4,
                {result_of(straight_drive(1.025)), result_of(straight_drive(1.02)),
                 result_of(straight_drive(1.01))},
                truth));
  sample.drives.push_back(
      *drive_of("<hills>", 5,
                {result_of(straight_drive(1.02, 150)), result_of(straight_drive(1.01)),
                 result_of(straight_drive(1.005))},
                truth));
  return sample;
}

}  // namespace

TEST_CASE("a drive has drift, slips, position error and times of every method") {
  const TableSample sample = example_sample();
  const DriveSample& hills = sample.drives[1];
  CHECK(hills.drive == "<hills>");
  CHECK(hills.seed == 5);
  CHECK(hills.path_m == doctest::Approx(299.0));
  REQUIRE(hills.methods.size() == 3);
  CHECK(hills.methods[0].slips.size() == 1);
  CHECK(hills.methods[0].slam_ms == doctest::Approx(10.0));
  CHECK(drift(hills.methods[1].pieces).translation_percent == doctest::Approx(1.0));
  // Aligned by its centre, a line that is 1 % long is off by 1 % of the distance from there: of
  // positions 0 to 299 the deviation is sqrt((300^2 - 1) / 12).
  CHECK(hills.methods[1].ape_m == doctest::Approx(0.01 * std::sqrt((300.0 * 300.0 - 1.0) / 12.0)));
}

TEST_CASE("a drive whose stamps are not the truth's has no figures") {
  Trajectory later = straight_drive(1.0);
  for (StampedPose& pose : later) pose.stamp_s += 1000.0;
  CHECK_FALSE(drive_of("town", 1, {result_of(later)}, straight_drive(1.0)));
}

TEST_CASE("the truth of a longer drive is cut where the scans end") {
  Trajectory half = straight_drive(1.0);
  half.resize(200);
  const auto drive = drive_of("town", 1, {result_of(half)}, straight_drive(1.0));
  CHECK(drive->path_m == doctest::Approx(199.0));
}

TEST_CASE("a summary is the mean over drives, slips are per 100 km of all of them") {
  const MethodStatistics sixteen = statistics_of(example_sample(), 0);
  // On the second drive half of the 200 pieces hold the jump: sqrt(2^2 + 0.5^2) % instead of 2 %.
  const double second = 0.5 * (2.0 + std::sqrt(4.25));
  CHECK(sixteen.drift_percent.value == doctest::Approx((2.5 + second) / 2.0));
  CHECK(sixteen.drift_percent_no_slip.value == doctest::Approx(2.25));
  CHECK(sixteen.slips == 1);
  CHECK(sixteen.slips_per_100_km.value == doctest::Approx(1e5 / 598.0));
  CHECK(sixteen.slips_per_100_km.low == 0.0);
  CHECK(sixteen.slam_ms == doctest::Approx(10.0));
  CHECK(statistics_of(example_sample(), 2).drift_percent.value == doctest::Approx(0.75));
}

TEST_CASE("pairs are differences and ratios drive by drive, and the share of the gap closed") {
  const TableSample sample = example_sample();
  const MethodStatistics all_rows = statistics_of(sample, 2);
  CHECK(all_rows.drift_difference_percent.value == doctest::Approx(-0.75));
  CHECK(all_rows.drift_difference_percent.low == doctest::Approx(-1.0));
  CHECK(all_rows.drift_difference_percent.high == doctest::Approx(-0.5));
  CHECK(all_rows.drift_ratio.value == doctest::Approx(0.5));
  CHECK(all_rows.gap_closed->value == doctest::Approx(1.0));
  const MethodStatistics sixteen = statistics_of(sample, 0);
  CHECK(sixteen.drift_ratio_no_slip.value == doctest::Approx(1.5));
  CHECK(sixteen.slips_difference.value == doctest::Approx(1e5 / 598.0));
  CHECK(sixteen.gap_closed->value == doctest::Approx(0.0));
  const MethodStatistics linear = statistics_of(of_drive(sample, "town"), 1);
  CHECK(linear.gap_closed->value == doctest::Approx(1.0 / 3.0));
  CHECK(linear.drift_ratio.value == doctest::Approx(1.0));
}

TEST_CASE("without LiDAR-16 or LiDAR-64 there is no gap to close") {
  TableSample sample = example_sample();
  sample.methods.pop_back();
  for (DriveSample& drive : sample.drives) drive.methods.pop_back();
  CHECK_FALSE(statistics_of(sample, 1).gap_closed);
}

TEST_CASE("a drive shorter than a piece has slips but no drift, and does not spoil the mean") {
  TableSample sample = example_sample();
  Trajectory shorter = straight_drive(1.0);
  shorter.resize(50);
  const TableResult result = result_of(shorter);
  sample.drives.push_back(*drive_of("town", 9, {result, result, result}, straight_drive(1.0)));
  CHECK(statistics_of(sample, 1).drift_percent.value == doctest::Approx(1.5));
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
