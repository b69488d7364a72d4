#include "table/table_figures.h"

#include <doctest/doctest.h>

#include "table/table_report.h"
#include "tools/example_table.h"
#include "tools/parts_of_text.h"

namespace hqslam::tools {
namespace {

using test::example_result;
using test::example_trajectory;

/// LiDAR-16 off by 0.4 m, DU-OR by 0.1 m, LiDAR-64 by 0.05 m the other way, all twice that with
/// loop closing.
DriveFigures three_methods_drive(bool with_truth) {
  const std::vector<TableMethod> methods = {table_methods()[0], table_methods()[7],
                                            table_methods().back()};
  std::vector<TableResult> results;
  for (std::size_t i = 0; i < methods.size(); ++i) {
    results.push_back(example_result(methods[i], i == 0 ? 0.4 : i == 1 ? 0.1 : -0.05));
  }
  std::optional<TrajectoryFile> truth;
  if (with_truth) truth = TrajectoryFile{"truth.tum", example_trajectory(0.0), true};
  TableDrive drive;
  drive.name = "town";
  return drive_figures(drive, "os1-64", results, truth);
}

}  // namespace

// Bumps up and down in turn along a long path turn the alignment by next to nothing: each error is
// the bump.
TEST_CASE("errors are those of the bumps, against LiDAR-64 and against the truth") {
  const DriveFigures drive = three_methods_drive(true);
  REQUIRE(drive.methods.size() == 3);
  const TableResult& du_or = drive.methods[1];
  CHECK(du_or.against_all_rows[kLoopClosingOff]->ape_rmse_m() ==
        doctest::Approx(0.15).epsilon(0.01));
  CHECK(du_or.against_all_rows[kLoopClosingOn]->ape_rmse_m() == doctest::Approx(0.3).epsilon(0.01));
  CHECK(du_or.against_truth[kLoopClosingOff]->ape_rmse_m() == doctest::Approx(0.1).epsilon(0.01));
  CHECK(du_or.against_truth[kLoopClosingOn]->ape_rmse_m() == doctest::Approx(0.2).epsilon(0.01));
  // 39 steps of 2 * 124 m * sin(pi / 78).
  CHECK(du_or.against_truth[kLoopClosingOff]->path_m == doctest::Approx(389.45).epsilon(1e-4));
  CHECK(du_or.against_truth[kLoopClosingOff]->ape_percent() ==
        doctest::Approx(100.0 * 0.1 / 389.45).epsilon(0.01));
  CHECK_FALSE(drive.methods[2].against_all_rows[kLoopClosingOff]);
  CHECK(drive.methods[2].against_truth[kLoopClosingOff]->ape_rmse_m() ==
        doctest::Approx(0.05).epsilon(0.01));
}

TEST_CASE("without LiDAR-64 or without the truth the errors against it are not there") {
  const DriveFigures drive = three_methods_drive(false);
  CHECK(drive.truth.empty());
  CHECK_FALSE(drive.methods[0].against_truth[kLoopClosingOff]);
  const DriveFigures alone =
      drive_figures({}, "os1-64", {example_result(table_methods()[0], 0.4)}, {});
  CHECK_FALSE(alone.methods[0].against_all_rows[kLoopClosingOff]);
}

TEST_CASE("the path is the reference's, along the poses that were compared") {
  const Trajectory reference = example_trajectory(0.0);
  Trajectory estimate;
  for (std::size_t i = 0; i < reference.size(); i += 2) estimate.push_back(reference[i]);
  // 19 chords of 2 * 124 m * sin(pi / 39).
  CHECK(error_figures(estimate, reference)->path_m == doctest::Approx(379.15).epsilon(1e-4));
}

TEST_CASE("drift is taken over 100 m, and over nothing if the path is shorter") {
  Trajectory estimate = example_trajectory(0.0);
  const Trajectory reference = estimate;
  for (StampedPose& pose : estimate) pose.T_map_sensor.translation() *= 1.02;
  CHECK(error_figures(estimate, reference)->rpe_percent() == doctest::Approx(2.0).epsilon(0.1));
  CHECK(*error_figures(estimate, reference)->rpe_deg_per_100m() == doctest::Approx(0.0));
  estimate.resize(9);
  CHECK_FALSE(
      error_figures(estimate, Trajectory(reference.begin(), reference.begin() + 9))->rpe_percent());
  estimate.resize(2);
  CHECK_FALSE(error_figures(estimate, reference));
}

TEST_CASE("speed: upsampling by the median, the chain by upsampling, points and SLAM together") {
  const DriveFigures drive = three_methods_drive(true);
  CHECK_FALSE(drive.methods[0].upsampling_fps());
  CHECK(drive.methods[0].chain_fps(kLoopClosingOff) == doctest::Approx(40 / 0.4));
  CHECK(*drive.methods[1].upsampling_fps() == doctest::Approx(250.0));
  CHECK(drive.methods[1].chain_fps(kLoopClosingOff) == doctest::Approx(40 / 0.8));
  CHECK(drive.methods[1].chain_fps(kLoopClosingOn) == doctest::Approx(40 / 2.0));
}

TEST_CASE("three digits that count") {
  CHECK(three_digits(0.0424) == "0.042");
  CHECK(three_digits(0.99949) == "0.999");
  CHECK(three_digits(0.99951) == "1.00");
  CHECK(three_digits(3.784) == "3.78");
  CHECK(three_digits(9.95) == "9.95");
  CHECK(three_digits(9.996) == "10.0");
  CHECK(three_digits(31.71) == "31.7");
  CHECK(three_digits(99.96) == "100");
  CHECK(three_digits(6717.2) == "6717");
}

TEST_CASE("the paper's table has one figure per drive, and a dash where a drive lacks the method") {
  const DriveFigures whole = three_methods_drive(true);
  DriveFigures part = whole;
  part.methods.erase(part.methods.begin() + 1);
  part.name = "hills";
  const TextTable table = paper_table({whole, part}, kLoopClosingOff);
  CHECK(table.columns[1] == "RMSE against LiDAR-64, m (town / hills)");
  REQUIRE(table.rows.size() == 3);
  CHECK(table.rows[0] ==
        std::vector<std::string>{"LiDAR-16", "0.450 / 0.450", "- / -", "100 / 100", "-"});
  CHECK(table.rows[1] ==
        std::vector<std::string>{"DU-OR", "0.150 / -", "250 / -", "50.0 / -", "175k"});
}

TEST_CASE("the trajectory table relates every error to that of LiDAR-16") {
  const DriveFigures drive = three_methods_drive(true);
  const TextTable off = trajectory_table(drive, kLoopClosingOff);
  CHECK(off.rows[1][0] == "DU-OR");
  CHECK(off.rows[1][1] == "0.150");
  CHECK(off.rows[1][3] == "0.33");
  CHECK(off.rows[1][6] == "0.25");
  CHECK(off.rows[1].back() == "11.0");
  CHECK(trajectory_table(drive, kLoopClosingOn).rows[1].back() == "-");
  for (const std::size_t loop_closing : {kLoopClosingOff, kLoopClosingOn}) {
    for (const bool with_truth : {false, true}) {
      const TextTable table = trajectory_table(three_methods_drive(with_truth), loop_closing);
      for (const auto& row : table.rows) CHECK(row.size() == table.columns.size());
    }
  }
}

TEST_CASE("the upsampling table leaves out what does not upsample") {
  const TextTable table = upsampling_table(three_methods_drive(true));
  REQUIRE(table.rows.size() == 1);
  CHECK(table.rows[0] ==
        std::vector<std::string>{"DU-OR", "2.50", "0.250", "6.25", "250", "175k", "0.367"});
}

TEST_CASE("the page of Markdown holds every table, the machine and the weights") {
  const std::string text = markdown_of(drives_report({three_methods_drive(true)}));
  CHECK(missing(text, {"## Loop closing off", "## Loop closing on", "## town",
                       "### Trajectory, loop closing on", "### Upsampling", "SE(3)",
                       "a processor, 1 thread, portable", "du-or.npz (hash 17)",
                       "| DU-OR | 0.300 |"}) == "");
}

TEST_CASE("times are only in the JSON's timings: other times leave the rest as it is") {
  DriveFigures drive = three_methods_drive(true);
  const std::string before = drives_json({drive});
  drive.methods[1].timings.upsampling_ms = 8.0;
  drive.methods[1].timings.slam[0] = {9.0, 9.0, 9.0};
  const std::string after = drives_json({drive});
  const std::size_t timings = before.find("\"timings\"");
  REQUIRE(timings != std::string::npos);
  CHECK(before.substr(0, timings) == after.substr(0, timings));
  CHECK(before != after);
}

}  // namespace hqslam::tools
