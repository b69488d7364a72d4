#include "table/table_report.h"

#include "tools/lab/table/example_drives.h"
#include "tools/parts_of_text.h"

namespace hqslam::tools {
namespace {

std::vector<PartReport> reports_of(const TablePlan& plan,
                                   const std::vector<FinishedDrive>& drives) {
  std::vector<PartReport> reports;
  for (const TablePart& part : parts_of(plan, drives)) reports.push_back(report_of(part));
  return reports;
}

std::vector<PartReport> example_reports() {
  return reports_of(example_plan(true), example_drives());
}

}  // namespace

TEST_CASE("the texts have a row per method and a part per kind of drive") {
  const std::vector<PartReport> reports = example_reports();
  REQUIRE(reports.size() == 3);
  const TextTable& summary = reports[0].tables[0];
  REQUIRE(summary.rows.size() == 3);
  CHECK(summary.rows[2][1] == "0.7500 [0.5000, 1.0000]");
  CHECK(summary.rows[0][3] == "1");
  const TextTable& pairs = reports[0].tables[1];
  CHECK(pairs.title == "Drive by drive against linear");
  CHECK(pairs.rows[1][1] == "-");
  CHECK(pairs.rows[2][2] == "0.50 [0.50, 0.50]");
  for (const TextTable& text : {summary, pairs}) {
    for (const auto& row : text.rows) CHECK(row.size() == text.columns.size());
  }
  CHECK(missing(markdown_of(reports), {"## All drives", "## town", "## <hills>", "seed 4",
                                       "| LiDAR-64 |", "300 scans, 299 m"}) == "");
  CHECK(missing(printed(reports), {"All drives\n", "<hills>: seed 5", "\nLiDAR-64 "}) == "");
  CHECK_FALSE(holds(printed(reports), "\ntown\n"));
}

TEST_CASE("the page's data have tables and paired drifts, and maps of drives that stand alone") {
  const nlohmann::ordered_json part = page_data(example_reports())["parts"][0];
  CHECK(part["tables"].size() == 2);
  CHECK(part["paired_with"] == "linear");
  REQUIRE(part["paired_drifts"].size() == 2);
  CHECK(part["paired_drifts"][1]["name"] == "LiDAR-64");
  CHECK(part["paired_drifts"][1]["dots"].size() == 2);
  CHECK(part["paired_drifts"][1]["mean"].get<double>() == doctest::Approx(-0.75));
  CHECK(part["error_map"]["paths"].empty());
  const auto alone =
      page_data(reports_of(example_plan(false), {example_drives().front()}))["parts"][1];
  CHECK(alone["error_map"]["reference"]["name"] == "LiDAR-64");
  CHECK(alone["error_map"]["paths"][1]["error_m"].size() == 300);
}

TEST_CASE("the JSON holds every part and every drive once, null where there is no interval") {
  const auto json = nlohmann::json::parse(json_of(example_reports()));
  CHECK(json["against"] == "linear");
  CHECK(json["methods"][2]["all"]["drift_percent"]["value"].get<double>() == doctest::Approx(0.75));
  CHECK(json["methods"][2]["town"]["drift_percent"]["low"].is_null());
  REQUIRE(json["drives"].size() == 2);
  CHECK(json["drives"][1]["methods"]["rows-16"]["slips"][0]["first_scan"] == 140);
}

}  // namespace hqslam::tools
