#include "table/table_report.h"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <string>

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
  return drive_figures({"<town>", {.input = "recording"}, "", std::nullopt}, "os1-64", results,
                       std::nullopt);
}

}  // namespace

TEST_CASE("the map has a path with an error per pose for every method but LiDAR-64") {
  const nlohmann::ordered_json map = error_map_of(reported_drive(true), kLoopClosingOff);
  const nlohmann::ordered_json& paths = map["paths"];
  REQUIRE(paths.size() == 2);
  CHECK(paths[0]["name"] == "LiDAR-16");
  CHECK(paths[1]["name"] == "DU-OR");
  CHECK(paths[1]["x_m"].size() == 40);
  CHECK(paths[1]["error_m"].size() == 40);
  CHECK(paths[1]["rmse_m"].get<double>() == doctest::Approx(0.4).epsilon(0.01));
  CHECK(paths[1]["distance_m"].back().get<double>() == doctest::Approx(389.45).epsilon(1e-4));
  CHECK(map["reference"]["x_m"].size() == 40);
}

TEST_CASE("long paths are thinned, each pose with its own error and distance") {
  const std::vector<TableMethod> methods = {table_methods()[0], table_methods().back()};
  std::vector<TableResult> results = {example_result(methods[0], 0.4),
                                      example_result(methods[1], 0.0)};
  for (TableResult& result : results) {
    for (Trajectory& trajectory : result.trajectory) {
      const Trajectory lap = trajectory;
      for (int i = 1; i <= 50; ++i) {
        for (StampedPose pose : lap) {
          pose.stamp_s += 4.0 * i;
          trajectory.push_back(pose);
        }
      }
    }
  }
  const nlohmann::ordered_json map =
      error_map_of(drive_figures({}, "os1-64", results, std::nullopt), kLoopClosingOff);
  REQUIRE(map["paths"].size() == 1);
  const nlohmann::ordered_json& path = map["paths"][0];
  CHECK(path["x_m"].size() == 51 * 40 / 3);  // every third pose
  CHECK(map["reference"]["x_m"].size() == path["x_m"].size());
  CHECK(path["error_m"].size() == path["x_m"].size());
  CHECK(path["distance_m"][2].get<double>() == doctest::Approx(6 * 389.45 / 39).epsilon(1e-3));
}

TEST_CASE("the page's data have tables and maps for loop closing off and on") {
  const nlohmann::ordered_json data = page_data(drives_report({reported_drive(true)}));
  CHECK(data["lead"].size() == 2);
  const nlohmann::ordered_json& part = data["parts"][0];
  CHECK(part["title"] == "<town>");
  CHECK(part["tables"].size() == 3);
  REQUIRE(part["error_maps"].size() == 2);
  CHECK(part["error_maps"][0]["title"] == "loop closing off");
  CHECK(part["error_maps"][0]["paths"][1]["name"] == "DU-OR");
  CHECK(part["error_maps"][0]["paths"][1]["error_m"].size() == 40);
  CHECK_FALSE(holds(data["notes"].dump(), kWithoutReference));
}

TEST_CASE("where nothing upsamples the table of upsampling has no rows") {
  const DriveFigures drive =
      drive_figures({}, "os1-64", {example_result(table_methods()[0], 0.4)}, std::nullopt);
  CHECK(drives_report({drive}).parts[0].tables.back().rows.empty());
}

TEST_CASE("without LiDAR-64 there are tables but no maps, and a note gives the reason") {
  const nlohmann::ordered_json data = page_data(drives_report({reported_drive(false)}));
  CHECK(data["parts"][0]["tables"].size() == 3);
  for (const auto& map : data["parts"][0]["error_maps"]) CHECK(map["paths"].empty());
  CHECK(count(data["notes"].dump(), kWithoutReference) == 1);
}

}  // namespace hqslam::tools
