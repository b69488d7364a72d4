#include "table/table_report.h"

#include <doctest/doctest.h>

#include <string>

#include "error_message.h"
#include "report/chart.h"
#include "tools/example_table.h"
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

TEST_CASE("the page shows tables, maps and charts for loop closing off and on, and needs nothing") {
  const std::string html = html_of(drives_report({reported_drive(true)}));
  CHECK(count(html, "<svg ") == 4 + 2);  // maps of two methods, charts
  CHECK(count(html, "<img ") == 0);
  CHECK(count(html, "<table>") == 5);
  CHECK(holds(html, "&lt;town&gt;"));
  CHECK_FALSE(holds(html, "<town>"));
  CHECK_FALSE(holds(html, "http"));
  CHECK_FALSE(holds(html, kWithoutReference));
}

TEST_CASE("one trajectory that leaves the map is cut off in the chart instead of flattening all") {
  const std::vector<TableMethod> methods = {table_methods()[0], table_methods()[7],
                                            table_methods().back()};
  const DriveFigures drive =
      drive_figures({}, "os1-64", methods,
                    {example_result(methods[0], 400.0), example_result(methods[1], 0.4),
                     example_result(methods[2], 0.0)},
                    std::nullopt);
  const std::string html = html_of(drives_report({drive}));
  CHECK(missing(html, {"(cut off at 1.2", ">1</span>"}) == "");
}

TEST_CASE("where nothing upsamples there is no table of it") {
  const std::vector<TableMethod> methods = {table_methods()[0]};
  const DriveFigures drive =
      drive_figures({}, "os1-64", methods, {example_result(methods[0], 0.4)}, std::nullopt);
  CHECK(count(html_of(drives_report({drive})), "<table>") == 4);
}

TEST_CASE("without LiDAR-64 the page has tables but neither maps nor charts, and says why") {
  const std::string html = html_of(drives_report({reported_drive(false)}));
  CHECK(error_map_of(reported_drive(false), kLoopClosingOff).panels.empty());
  CHECK(count(html, "<img ") == 0);
  CHECK(count(html, "<svg ") == 0);
  CHECK(count(html, "<table>") == 5);
  CHECK(count(html, kWithoutReference) == 1);
}

namespace {

/// A straight drive of 100 m to the right, once per largest error.
ErrorMap example_map(const std::vector<double>& largest_errors_m) {
  ErrorMap map;
  for (int i = 0; i <= 100; ++i) map.reference_m.emplace_back(i, 0.0);
  for (const double largest_m : largest_errors_m) {
    ErrorPanel panel{"panel", largest_m, map.reference_m, {}};
    panel.error_m.assign(101, 0.0);
    panel.error_m[50] = largest_m;
    map.panels.push_back(panel);
  }
  return map;
}

bool has_color(const std::string& svg, double share) {
  return holds(svg, error_color_of_class(error_color_class(share)));
}

}  // namespace

TEST_CASE("the scale ends at the largest error of all panels") {
  const ErrorScale scale = error_scale(example_map({0.2, 0.5, 0.3}));
  CHECK(scale.top_m == 0.5);
  CHECK_FALSE(scale.clipped);
  CHECK(top_text(scale) == "0.50 m");
}

TEST_CASE("one trajectory that leaves the map does not take the colours from the others") {
  const ErrorScale scale = error_scale(example_map({6717.0, 0.5, 0.3}));
  CHECK(scale.top_m == doctest::Approx(1.5));
  CHECK(scale.clipped);
  CHECK(top_text(scale) == "1.50 m or more");
}

TEST_CASE("without an error there is still a scale and a picture") {
  CHECK(error_scale({}).top_m > 0.0);
  const ErrorMap exact = example_map({0.0});
  CHECK(has_color(panel_svg(exact, 0, error_scale(exact)), 0.0));
}

TEST_CASE("a pose has the colour of its error: the last one of the scale, in every panel") {
  ErrorMap map = example_map({1.0, 1.0});
  map.panels[0].error_m.assign(101, 1.0);
  map.panels[1].error_m.assign(101, 0.5);
  const ErrorScale scale = error_scale(map);
  CHECK(has_color(panel_svg(map, 0, scale), 1.0));
  CHECK(has_color(panel_svg(map, 1, scale), 0.5));
  CHECK_FALSE(has_color(panel_svg(map, 1, scale), 1.0));
}

TEST_CASE("a trajectory is drawn to scale, in steps that can be seen, with a ring at its start") {
  // 100 m with margins of 12 m: 480 pixels for 124 m, the start at 46.5.
  ErrorMap map = example_map({1.0});
  const std::string svg = panel_svg(map, 0, error_scale(map));
  CHECK(missing(svg, {"<circle cx=\"46.5\"", "M46.5 ", "L433.5 "}) == "");
  for (ErrorPanel& panel : map.panels) {
    panel.path_m.clear();
    for (int i = 0; i <= 10000; ++i) panel.path_m.emplace_back(0.01 * i, 0.0);
    panel.error_m.assign(panel.path_m.size(), 0.0);
  }
  CHECK(panel_svg(map, 0, error_scale(map)).size() < 2 * svg.size());
}

TEST_CASE("the picture holds all panels with their names and grows with their number") {
  ErrorMap map = example_map({1.0, 0.5});
  map.panels[1].title = "a < b";
  const std::string two = error_map_svg(map, "drive & drive");
  CHECK(count(two, "<svg") == 3);
  CHECK(missing(two, {"a &lt; b", "drive &amp; drive", "width=\"1020\""}) == "");
  const std::string seven =
      error_map_svg(example_map({1.0, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5}), "drive");
  CHECK(count(seven, "<svg") == 8);
  CHECK(holds(seven, "width=\"2020\""));
  CHECK(test::refused_with([] { error_map_svg({}, "drive"); }, "expected at least one"));
}

}  // namespace hqslam::tools
