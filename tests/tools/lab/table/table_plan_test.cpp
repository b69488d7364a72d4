#include "table/table_plan.h"

#include "testing.h"

namespace hqslam::tools {

TEST_CASE("without a choice every method runs on the paper's two lengths") {
  const TablePlan plan = plan_table({.out = "out"});
  REQUIRE(plan.drives.size() == 2);
  CHECK(plan.drives[0].simulated->scans == 4000);
  CHECK(plan.drives[1].simulated->scans == 8000);
  CHECK(plan.methods.size() == table_methods().size());
  // The sensor is off as sensors are, and its drives have folders of their own.
  CHECK(plan.drives[1].simulated->sensor_errors == sim::SensorErrors::kTypical);
  CHECK(plan.drives[1].recording.input == "out/drives/hills-typical");
}

TEST_CASE("over seeds every drive is there from each seed") {
  const TablePlan plan = plan_table({.drives = {"town", "hills"},
                                     .methods = {"du-or", "rows-16"},
                                     .scans = 50,
                                     .sensor_errors = "none",
                                     .seeds = "3..4",
                                     .out = "out"});
  REQUIRE(plan.drives.size() == 4);
  CHECK(plan.drives[1].name == "town-seed-4");
  CHECK(plan.drives[2].simulated->name == "hills");
  CHECK(plan.drives[2].simulated->seed == 3);
  CHECK(plan.drives[2].simulated->scans == 50);
  CHECK(plan.drives[3].recording.input == "out/drives/hills-seed-4");
  CHECK(plan.methods[0].title == "DU-OR");
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

TEST_CASE("LeGO-LOAM is a row of its own, so are a weights file and no last filter") {
  const test::TemporaryDirectory folder;
  const std::string file = folder.file("mi+ne.npz");
  test::write_file(file, "");
  const TablePlan plan = plan_table({.methods = {"du-or+as-published", "rows-64", file},
                                     .weights = {file + "+as-published"},
                                     .out = "out"});
  REQUIRE(plan.methods.size() == 4);
  CHECK(plan.methods[0].title == "DU-OR, LeGO-LOAM");
  CHECK(plan.methods[0].source == "du-or");
  CHECK(plan.methods[1].rows == kTableAllRows);
  CHECK(plan.methods[2].name == "mi+ne");
  CHECK(plan.methods[3].name == "mi+ne+as-published");
  CHECK(plan.methods[3].source == file);
  const auto options_of = [](const char* method) {
    return slam_setup(method_named(method, "--methods"), sensor_preset("os1-64")).options;
  };
  CHECK_FALSE(options_of("du-or").slam_options.loop_closing.enabled);
  CHECK(options_of("du-or").slam == pipeline::SlamKind::kHqslam);
  CHECK(options_of("rows-16+as-published").slam == pipeline::SlamKind::kLegoLoam);
  for (const char* with : {"simple-du-filter", "du-or", "du-mix"}) {
    CHECK(upsampling_of(method_named(with, "")).network.filter_result);
  }
  for (const char* without : {"simple-du", "du-or-no-filter"}) {
    CHECK_FALSE(upsampling_of(method_named(without, "")).network.filter_result);
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
  options.reading.capture = "rolling";
  const TablePlan plan = plan_table(options);
  CHECK(plan.drives[0].name == "street");
  CHECK_FALSE(plan.drives[0].simulated);
  const InputChoice street = plan.drives[0].recording;
  CHECK(street.input == std::filesystem::canonical(folder.file("street")));
  CHECK(street.sensor == "hdl-64e");
  CHECK(street.capture == "rolling");
  CHECK(plan.drives[1].recording.sensor.empty());  // simulated
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
  CHECK(one_line_with(complaint({.methods = {"du-or+what"}}), "du-or+what", "+as-published"));
  CHECK(one_line_with(complaint({.weights = {"none.npz"}}), "--weights none.npz"));
  CHECK(one_line_with(complaint({.drives = {"moon"}}), "moon", "town"));
  CHECK(one_line_with(complaint({.drives = {"town", "town"}}), "--drives", "town", "twice"));
  CHECK(one_line_with(complaint({.methods = {"du-or", "du-or"}}), "--methods", "twice"));
  CHECK(one_line_with(complaint({.methods = {"rows-16"}, .seeds = "1..2", .against = "du-or"}),
                      "--against", "'du-or'"));
  CHECK(one_line_with(complaint({.drives = {"."}, .seeds = "1..2"}), "--seeds", "town", "'.'"));
}

}  // namespace hqslam::tools
