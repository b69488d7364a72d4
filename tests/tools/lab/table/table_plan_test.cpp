#include "table/table_plan.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "error_message.h"
#include "file_contents.h"
#include "temporary_directory.h"

namespace hqslam::tools {
namespace {

const auto found = [](const TablePlan& plan, const std::string& name) {
  return std::ranges::find(plan.shown, name, &TableMethod::name);
};

}  // namespace

TEST_CASE("without a choice every method runs on the paper's two lengths") {
  const TablePlan plan = plan_table({.out = "out"});
  REQUIRE(plan.drives.size() == 2);
  CHECK(plan.drives[0].simulated->scans == 4000);
  CHECK(plan.drives[1].simulated->scans == 8000);
  CHECK(plan.drives[1].recording.input == "out/drives/hills-typical");
  CHECK(plan.methods.size() == table_methods().size());
}

TEST_CASE("--scans shortens simulated drives and --methods chooses among the rows") {
  const TablePlan plan =
      plan_table({.drives = {"block"}, .methods = {"du-or", "rows-16"}, .scans = 30, .out = "out"});
  CHECK(plan.drives[0].simulated->scans == 30);
  REQUIRE(plan.methods.size() == 2);
  CHECK(plan.methods[0].title == "DU-OR");
}

TEST_CASE("over seeds every drive is there from each seed") {
  const TablePlan plan = plan_table({.drives = {"town", "hills"},
                                     .scans = 50,
                                     .sensor_errors = "none",
                                     .seeds = "3..4",
                                     .out = "out"});
  CHECK(plan.over_seeds);
  REQUIRE(plan.drives.size() == 4);
  CHECK(plan.drives[1].name == "town-seed-4");
  CHECK(plan.drives[2].simulated->name == "hills");
  CHECK(plan.drives[2].simulated->seed == 3);
  CHECK(plan.drives[2].simulated->scans == 50);
  CHECK(plan.drives[3].recording.input == "out/drives/hills-seed-4");
}

TEST_CASE("the sensor is off as sensors are, and its drives have folders of their own") {
  const TablePlan plan = plan_table({.drives = {"town"}, .seeds = "3", .out = "out"});
  REQUIRE(plan.drives.size() == 1);
  CHECK(plan.drives[0].recording.input == "out/drives/town-seed-3-typical");
  CHECK(plan.drives[0].simulated->sensor_errors == sim::SensorErrors::kTypical);
}

TEST_CASE("over seeds others are paired with what is named, with linear, or with the first") {
  TableOptions options{.methods = {"rows-16", "linear", "rows-64"}, .seeds = "1", .out = "out"};
  CHECK(plan_table(options).against == 1);
  CHECK(plan_table(options).shown.size() == 3);
  options.against = "rows-64";
  CHECK(plan_table(options).against == 2);
  options.against = "";
  options.methods = {"rows-16", "rows-64"};
  CHECK(plan_table(options).against == 0);
}

TEST_CASE("a variant of SLAM is a row behind its method, never without being asked for") {
  CHECK(std::ranges::none_of(table_methods(),
                             [](const TableMethod& method) { return method.variant != nullptr; }));
  const TablePlan plan =
      plan_table({.methods = {"du-or+whole-map", "rows-64+16-rows"}, .out = "out"});
  REQUIRE(plan.methods.size() == 2);
  CHECK(plan.methods[0].title == "DU-OR, the whole map matched");
  CHECK(plan.methods[0].source == "du-or");
  CHECK(plan.methods[0].filtered);
  CHECK_FALSE(is_reference(plan.methods[1]));
  CHECK(found(plan, "du-or") < found(plan, "du-or+whole-map"));
  CHECK(found(plan, "du-or+whole-map") < found(plan, "rows-64"));
  CHECK(found(plan, "rows-64+16-rows") < plan.shown.end());
}

TEST_CASE("methods that share a network share a pass, and all rows come first") {
  const auto passes = passes_of(table_methods());
  REQUIRE(passes.size() == 8);
  CHECK(passes[0].front().name == "rows-64");
  CHECK(passes[1].front().name == "rows-16");
  for (const auto& pass : passes) {
    CAPTURE(pass.front().name);
    // With and without the filter at the end; DU-Mix has none.
    const bool filtered = uses_network(pass.front()) && pass.front().source != "du-mix";
    CHECK(pass.size() == (filtered ? 2 : 1));
    CHECK(pass.front().source == pass.back().source);
  }
}

TEST_CASE("variants share what is interpolated, not a network: its memory has their own poses") {
  const auto passes = [](std::vector<std::string> methods) {
    return passes_of(plan_table({.methods = std::move(methods), .out = "out"}).methods).size();
  };
  CHECK(passes({"linear", "linear+whole-map"}) == 1);
  CHECK(passes({"du-mix", "du-mix+whole-map"}) == 2);
}

TEST_CASE("networks find the weights of the sensor, other methods need none") {
  for (const TableMethod& method : table_methods()) {
    CAPTURE(method.name);
    const std::string weights = weights_of(method, "hdl-64e");
    CHECK(weights.empty() != uses_network(method));
    if (!weights.empty()) {
      CHECK(std::filesystem::path(weights).filename() == method.source + "_hdl64e_16to64.npz");
    }
  }
  CHECK(test::refused_with([] { weights_of(table_methods()[7], "vls-128"); }, "du-or", "vls-128",
                           "--weights"));
}

TEST_CASE("a weights file becomes a filtered row before LiDAR-64") {
  const test::TemporaryDirectory folder;
  test::write_file(folder.file("mine.npz"), "");
  TableOptions options{.weights = {folder.file("mine.npz")}, .out = "out"};
  const TablePlan plan = plan_table(options);
  CHECK(plan.methods.back().name == "mine");
  CHECK(plan.methods.back().filtered);
  CHECK(weights_of(plan.methods.back(), "any") == folder.file("mine.npz"));
  REQUIRE(found(plan, "mine") != plan.shown.end());
  CHECK((found(plan, "mine") + 1)->name == "rows-64");

  options.weights = {folder.file("mine.npz") + "+as-published"};
  CHECK(plan_table(options).methods.back().name == "mine+as-published");
  CHECK(weights_of(plan_table(options).methods.back(), "any") == folder.file("mine.npz"));
  options.weights = {folder.file("mine.npz") + "+nothing"};
  CHECK(test::refused_with([&] { plan_table(options); }, "mine.npz+nothing", "+as-published"));
}

TEST_CASE("a recording is named after its folder and keeps the sensor and truth it was given") {
  const test::TemporaryDirectory folder;
  std::filesystem::create_directories(folder.file("kitti_drive/velodyne"));
  std::filesystem::create_directory(folder.file("street"));
  TableOptions options{.drives = {folder.file("kitti_drive/velodyne")}, .out = "out"};
  CHECK(plan_table(options).drives[0].name == "kitti_drive");
  options.drives = {folder.file("street") + "/", "town"};
  options.reading.sensor = "hdl-64e";
  options.reference = "truth.txt";
  options.reading.stamps = "names";
  options.reading.capture = "rolling";
  const TablePlan plan = plan_table(options);
  CHECK(plan.drives[0].name == "street");
  CHECK(plan.drives[0].reference == "truth.txt");
  CHECK_FALSE(plan.drives[0].simulated);
  const InputChoice street = plan.drives[0].recording;
  CHECK(street.input == std::filesystem::canonical(folder.file("street")));
  CHECK(street.sensor == "hdl-64e");
  CHECK(street.stamps == "names");
  CHECK(street.capture == "rolling");
  CHECK(plan.drives[1].recording.stamps.empty());  // simulated
  CHECK(plan.drives[1].recording.sensor.empty());
  CHECK(plan.drives[1].reference.empty());
  options.reading.stream = "7502";
  CHECK(test::refused_with([&] { plan_table(options); }, "street", "leave --stream out"));
}

TEST_CASE("unknown names and names that are there twice are refused in one line") {
  const auto complaint = [](TableOptions options) {
    options.out = "out";
    return test::error_message([&] { plan_table(options); });
  };
  using test::one_line_with;
  CHECK(one_line_with(complaint({.methods = {"du-and"}}), "du-and", "rows-16", "du-or"));
  CHECK(one_line_with(complaint({.methods = {"rows-16+computed-rows"}}),  // it has none
                      "rows-16+computed-rows", "+whole-map"));
  CHECK(one_line_with(complaint({.drives = {"moon"}}), "moon", "town"));
  CHECK(one_line_with(complaint({.drives = {"town", "town"}}), "--drives", "town", "twice"));
  CHECK(one_line_with(complaint({.methods = {"du-or", "du-or"}}), "--methods", "twice"));
  CHECK(one_line_with(complaint({.methods = {"rows-16"}, .seeds = "1..2", .against = "du-or"}),
                      "--against", "'du-or'"));
  CHECK(one_line_with(complaint({.drives = {"."}, .seeds = "1..2"}), "--seeds", "town", "'.'"));
  CHECK(one_line_with(complaint({.weights = {"none.npz"}}), "--weights none.npz"));
  CHECK(one_line_with(complaint({.reference = "truth.txt"}), "--reference", "found 0"));
}

namespace {

/// 64 rows of which every fourth was measured.
SensorModel upsampled_sensor() {
  SensorModel sensor = sensor_preset("os1-64");
  sensor.measured_rows = selection_for(kTableAllRows, kTableMeasuredRows);
  return sensor;
}

SlamSetup setup_of(const std::string& method, const SensorModel& sensor) {
  return slam_setup(plan_table({.methods = {method}, .out = "out"}).methods.front(), sensor, true);
}

}  // namespace

TEST_CASE("without a variant SLAM runs as hqslam run does") {
  const SlamSetup plain = setup_of("du-or", upsampled_sensor());
  const slam::MappingOptions usual;
  CHECK(plain.options.slam_options.loop_closing.enabled);
  CHECK(plain.sensor.measured_rows.has_value());
  CHECK(plain.options.slam_options.mapping.recent_path_m == usual.recent_path_m);
  CHECK(plain.options.slam_options.mapping.trusted_residual_m == usual.trusted_residual_m);
  CHECK(plain.options.slam_options.mapping.max_ground_residual_m == usual.max_ground_residual_m);
}

TEST_CASE("every variant takes away the part that it names, and the options stay valid") {
  const SensorModel upsampled = upsampled_sensor();
  const SensorModel all = sensor_preset("os1-64");
  CHECK_FALSE(setup_of("du-or+computed-rows", upsampled).sensor.measured_rows);
  const std::optional<RowSelection> matched = setup_of("rows-64+16-rows", all).sensor.measured_rows;
  REQUIRE(matched);
  CHECK(*matched == selection_for(kTableAllRows, kTableMeasuredRows));
  CHECK(setup_of("rows-16+whole-map", all).options.slam_options.mapping.recent_path_m > 1e9);
  CHECK(setup_of("rows-16+plain-weights", all).options.slam_options.mapping.trusted_residual_m >
        1e9);
  CHECK(setup_of("rows-16+as-published", all).options.slam == pipeline::SlamKind::kLegoLoam);
  CHECK(setup_of("rows-64+bent-ground", all).options.slam_options.mapping.max_ground_residual_m ==
        0.2);
  for (const SlamVariant& variant : slam_variants()) {
    for (const TableMethod& method : table_methods()) {
      if (!variant.applies(method)) continue;
      CAPTURE(method.name);
      CAPTURE(variant.name);
      slam::validate(setup_of(method.name + "+" + variant.name, all).options.slam_options);
    }
  }
}

}  // namespace hqslam::tools
