#include <doctest/doctest.h>

#include "laboratory/table/table_report.h"
#include "tools/example_table.h"

namespace hqslam::tools {
namespace {

DriveFigures example_drive(bool with_all_rows) {
  std::vector<TableMethod> methods = {table_methods()[0], table_methods()[7]};
  if (with_all_rows) methods.push_back(table_methods().back());
  std::vector<TableResult> results;
  for (const TableMethod& method : methods) {
    results.push_back(test::example_result(method, method.rows == kTableAllRows ? 0.0 : 0.4));
  }
  return drive_figures({"<town>", {.input = "recording"}, "", std::nullopt}, "os1-64", methods,
                       results, std::nullopt);
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++found;
  }
  return found;
}

}  // namespace

TEST_CASE("the map has a panel with a colour per pose for every method but LiDAR-64") {
  const ErrorMap map = error_map_of(example_drive(true), kLoopClosingOff);
  REQUIRE(map.panels.size() == 2);
  CHECK(map.panels[0].title == "LiDAR-16");
  CHECK(map.panels[1].title == "DU-OR");
  CHECK(map.panels[1].path_m.size() == 40);
  CHECK(map.panels[1].error_m.size() == 40);
  CHECK(map.panels[1].rmse_m == doctest::Approx(0.4).epsilon(0.01));
  CHECK(map.reference_m.size() == 40);
}

TEST_CASE("the page shows tables, maps and charts for loop closing off and on, and needs nothing") {
  const std::string html = html_of(drives_report({example_drive(true)}));
  CHECK(count(html, "<svg ") == 4 + 2);  // maps of two methods, charts
  CHECK(count(html, "<img ") == 0);
  CHECK(count(html, "<table>") == 5);
  CHECK(html.find("&lt;town&gt;") != std::string::npos);
  CHECK(html.find("<town>") == std::string::npos);
  CHECK(html.find("http") == std::string::npos);
}

TEST_CASE("a table without LiDAR-64 says why nothing is compared with it") {
  const std::string why = "rows-64 was not among the methods";
  CHECK(count(html_of(drives_report({example_drive(false)})), why) == 1);
  CHECK(count(html_of(drives_report({example_drive(true)})), why) == 0);
}

TEST_CASE("one trajectory that leaves the map is cut off in the chart instead of flattening all") {
  const std::vector<TableMethod> methods = {table_methods()[0], table_methods()[7],
                                            table_methods().back()};
  const DriveFigures drive =
      drive_figures({}, "os1-64", methods,
                    {test::example_result(methods[0], 400.0), test::example_result(methods[1], 0.4),
                     test::example_result(methods[2], 0.0)},
                    std::nullopt);
  const std::string html = html_of(drives_report({drive}));
  CHECK(html.find("(cut off at 1.2") != std::string::npos);
  CHECK(html.find(">1</span>") != std::string::npos);
}

TEST_CASE("where nothing upsamples there is no table of it") {
  const std::vector<TableMethod> methods = {table_methods()[0]};
  const DriveFigures drive =
      drive_figures({}, "os1-64", methods, {test::example_result(methods[0], 0.4)}, std::nullopt);
  CHECK(count(html_of(drives_report({drive})), "<table>") == 4);
}

TEST_CASE("without LiDAR-64 the page has tables but neither maps nor charts") {
  const std::string html = html_of(drives_report({example_drive(false)}));
  CHECK(error_map_of(example_drive(false), kLoopClosingOff).panels.empty());
  CHECK(count(html, "<img ") == 0);
  CHECK(count(html, "<svg ") == 0);
  CHECK(count(html, "<table>") == 5);
}

}  // namespace hqslam::tools
