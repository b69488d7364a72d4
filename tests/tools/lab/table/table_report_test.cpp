#include "table/table_report.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "tools/example_table.h"
#include "tools/page_data.h"
#include "tools/parts_of_text.h"

namespace hqslam::tools {
namespace {

using test::example_result;

constexpr const char* kWithoutReference = "rows-64 was not among the methods";

DriveFigures reported_drive(bool with_all_rows) {
  std::vector<TableMethod> methods = {table_methods()[0], table_methods()[7]};
  if (with_all_rows) methods.push_back(table_methods().back());
  std::vector<TableResult> results;
  for (const TableMethod& method : methods) {
    results.push_back(example_result(method, method.rows == kTableAllRows ? 0.0 : 0.4));
  }
  return drive_figures({"<town>", {.input = "recording"}, "", std::nullopt}, "os1-64", methods,
                       results, std::nullopt);
}

}  // namespace

TEST_CASE("the map has a panel with a colour per pose for every method but LiDAR-64") {
  const ErrorMap map = error_map_of(reported_drive(true), kLoopClosingOff);
  REQUIRE(map.panels.size() == 2);
  CHECK(map.panels[0].title == "LiDAR-16");
  CHECK(map.panels[1].title == "DU-OR");
  CHECK(map.panels[1].path_m.size() == 40);
  CHECK(map.panels[1].error_m.size() == 40);
  CHECK(map.panels[1].rmse_m == doctest::Approx(0.4).epsilon(0.01));
  CHECK(map.reference_m.size() == 40);
}

TEST_CASE("the page has tables, maps and errors for loop closing off and on") {
  const nlohmann::json data = test::data_of(html_of(drives_report({reported_drive(true)})));
  CHECK(data["lead"].size() == 2);
  const nlohmann::json& part = data["parts"][0];
  CHECK(part["title"] == "<town>");
  CHECK(part["tables"].size() == 3);
  REQUIRE(part["figures"].size() == 2);
  CHECK(part["figures"][0]["loop_closing"] == "off");
  CHECK(part["figures"][1]["loop_closing"] == "on");
  const nlohmann::json& panel = part["figures"][0]["panels"][1];
  CHECK(panel["title"] == "DU-OR");
  for (const char* key : {"x", "y", "error_m", "distance_m"}) {
    CHECK(test::numbers_of(panel[key]).size() == 40);
  }
  CHECK_FALSE(holds(data.dump(), kWithoutReference));
}

TEST_CASE("where nothing upsamples there is no table of it") {
  const std::vector<TableMethod> methods = {table_methods()[0]};
  const DriveFigures drive =
      drive_figures({}, "os1-64", methods, {example_result(methods[0], 0.4)}, std::nullopt);
  const nlohmann::json data = test::data_of(html_of(drives_report({drive})));
  CHECK(data["parts"][0]["tables"].size() == 2);
}

TEST_CASE("without LiDAR-64 the page has tables but no figures, and gives the reason") {
  const std::string html = html_of(drives_report({reported_drive(false)}));
  CHECK(error_map_of(reported_drive(false), kLoopClosingOff).panels.empty());
  const nlohmann::json data = test::data_of(html);
  CHECK(data["parts"][0]["figures"].empty());
  CHECK(data["parts"][0]["tables"].size() == 3);
  CHECK(count(html, kWithoutReference) == 1);
}

TEST_CASE("a long trajectory is thinned, and the largest error stays in it") {
  TableMethod method = table_methods()[0];
  const TableMethod all_rows = table_methods().back();
  TableResult result = example_result(method, 0.0);
  result.trajectory[0].clear();
  for (int i = 0; i < 10'000; ++i) {
    StampedPose pose{0.1 * i, Pose::Identity()};
    pose.T_map_sensor.translation() = Eigen::Vector3d(i, i % 7, i == 5001 ? 3.0 : 0.0);
    result.trajectory[0].push_back(pose);
  }
  TableResult reference = example_result(all_rows, 0.0);
  reference.trajectory[0] = result.trajectory[0];
  reference.trajectory[0][5001].T_map_sensor.translation().z() = 0.0;
  const ErrorMap map =
      error_map_of(drive_figures({}, "os1-64", {method, all_rows}, {result, reference}, {}), 0);
  REQUIRE(map.panels.size() == 1);
  CHECK(map.panels[0].path_m.size() <= ErrorMap::kMostPoses + 1);
  CHECK(std::ranges::max(map.panels[0].error_m) == doctest::Approx(3.0).epsilon(0.01));
}

namespace {

/// A straight drive of 100 m to the right, once per largest error.
ErrorMap example_map(const std::vector<double>& largest_errors_m) {
  ErrorMap map;
  for (int i = 0; i <= 100; ++i) map.reference_m.emplace_back(i, 0.0);
  for (const double largest_m : largest_errors_m) {
    ErrorPanel panel{"panel", largest_m, map.reference_m, {}, {}};
    panel.error_m.assign(101, 0.0);
    panel.error_m[50] = largest_m;
    map.panels.push_back(panel);
  }
  return map;
}

}  // namespace

TEST_CASE("the scale ends at the largest error of all panels") {
  const ErrorScale scale = error_scale(example_map({0.2, 0.5, 0.3}));
  CHECK(scale.top_m == 0.5);
  CHECK_FALSE(scale.clipped);
}

TEST_CASE("one trajectory that leaves the map does not take the colours from the others") {
  const ErrorScale scale = error_scale(example_map({6717.0, 0.5, 0.3}));
  CHECK(scale.top_m == doctest::Approx(1.5));
  CHECK(scale.clipped);
}

TEST_CASE("without an error there is still a scale") { CHECK(error_scale({}).top_m > 0.0); }

}  // namespace hqslam::tools
