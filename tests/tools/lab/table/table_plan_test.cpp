#include "table/table_plan.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "error_message.h"
#include "file_contents.h"
#include "temporary_directory.h"

namespace hqslam::tools {
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

TEST_CASE("others are paired with what is named, with linear, or with the first") {
  TableOptions options{.methods = {"rows-16", "linear", "rows-64"}, .seeds = "1", .out = "out"};
  CHECK(plan_table(options).against == 1);
  options.against = "rows-64";
  CHECK(plan_table(options).against == 2);
  options.against = "";
  options.methods = {"rows-16", "rows-64"};
  CHECK(plan_table(options).against == 0);
}

TEST_CASE("a variant of SLAM is a row of its own, a weights file as well") {
  const test::TemporaryDirectory folder;
  const std::string file = folder.file("mi+ne.npz");
  test::write_file(file, "");
  const TablePlan plan = plan_table({.methods = {"du-or+whole-map", "rows-64+16-rows", file},
                                     .weights = {file + "+as-published"},
                                     .out = "out"});
  REQUIRE(plan.methods.size() == 4);
  CHECK(plan.methods[0].title == "DU-OR, the whole map matched");
  CHECK(plan.methods[0].source == "du-or");
  CHECK(plan.methods[1].rows == kTableAllRows);
  CHECK(plan.methods[2].name == "mi+ne");
  CHECK(plan.methods[3].name == "mi+ne+as-published");
  CHECK(plan.methods[3].source == file);
  const auto complaint = [&](const std::string& weights) {
    return test::error_message([&] { plan_table({.weights = {weights}, .out = "out"}); });
  };
  CHECK(test::one_line_with(complaint(file + "+nothing"), "mi+ne.npz+nothing", "+as-published"));
  CHECK(test::one_line_with(complaint("none.npz"), "--weights none.npz"));
}

TEST_CASE("networks run with their last filter, but where a row is for going without") {
  for (const TableMethod& method : table_methods()) {
    CAPTURE(method.name);
    const bool is_without = method.name == "simple-du" || method.name == "du-or-no-filter";
    CHECK(upsampling_of(method).network.filter_result == !is_without);
  }
}

TEST_CASE("a recording is named after its folder and keeps the sensor it was given") {
  const test::TemporaryDirectory folder;
  std::filesystem::create_directories(folder.file("kitti_drive/velodyne"));
  std::filesystem::create_directory(folder.file("street"));
  TableOptions options{.drives = {folder.file("kitti_drive/velodyne")}, .out = "out"};
  CHECK(plan_table(options).drives[0].name == "kitti_drive");
  options.drives = {folder.file("street") + "/", "town"};
  options.reading.sensor = "hdl-64e";
  options.reading.stamps = "names";
  options.reading.capture = "rolling";
  const TablePlan plan = plan_table(options);
  CHECK(plan.drives[0].name == "street");
  CHECK_FALSE(plan.drives[0].simulated);
  const InputChoice street = plan.drives[0].recording;
  CHECK(street.input == std::filesystem::canonical(folder.file("street")));
  CHECK(street.sensor == "hdl-64e");
  CHECK(street.stamps == "names");
  CHECK(street.capture == "rolling");
  CHECK(plan.drives[1].recording.stamps.empty());  // simulated
  CHECK(plan.drives[1].recording.sensor.empty());
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
  CHECK(one_line_with(complaint({.drives = {"moon"}}), "moon", "town"));
  CHECK(one_line_with(complaint({.drives = {"town", "town"}}), "--drives", "town", "twice"));
  CHECK(one_line_with(complaint({.methods = {"du-or", "du-or"}}), "--methods", "twice"));
  CHECK(one_line_with(complaint({.methods = {"rows-16"}, .seeds = "1..2", .against = "du-or"}),
                      "--against", "'du-or'"));
  CHECK(one_line_with(complaint({.drives = {"."}, .seeds = "1..2"}), "--seeds", "town", "'.'"));
}

namespace {

/// 64 rows of which every fourth was measured.
SensorModel upsampled_sensor() {
  SensorModel sensor = sensor_preset("os1-64");
  sensor.measured_rows = selection_for(kTableAllRows, kTableMeasuredRows);
  return sensor;
}

SlamSetup setup_of(const std::string& method, const SensorModel& sensor) {
  return slam_setup(method_named(method, "--methods"), sensor);
}

}  // namespace

TEST_CASE("without a variant SLAM runs as hqslam run --no-loop-closing does") {
  const SlamSetup plain = setup_of("du-or", upsampled_sensor());
  const slam::MappingOptions usual;
  CHECK_FALSE(plain.options.slam_options.loop_closing.enabled);
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
      CAPTURE(method.name);
      CAPTURE(variant.name);
      slam::validate(setup_of(method.name + "+" + variant.name, all).options.slam_options);
    }
  }
}

}  // namespace hqslam::tools
