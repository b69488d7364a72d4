#include "table/table_run.h"

#include "made_images.h"

namespace hqslam::tools {
namespace {

/// A stack of two images of an os1-16, of which the second has this range.
std::string stack(float range_m, const std::string& path) {
  write_stack(path, {RangeImage(16, 1024), flat_image(16, 1024, range_m)});
  return path;
}

/// The name of the file of the plan's first run.
std::string run_name(const TablePlan& plan) {
  return std::filesystem::path(runs_of(plan).front().paths.front()).filename();
}

TablePlan plan_of(const std::string& recording) {
  TablePlan plan;
  plan.drives = {{"name", {.input = recording, .sensor = "os1-16"}, std::nullopt}};
  plan.methods = {{"a", "a"}};
  return plan;
}

}  // namespace

TEST_CASE("a run is the same wherever its scans are, and another one with other scans") {
  const TemporaryDirectory folder;
  const std::string name = run_name(plan_of(stack(2.0F, folder.file("a.npy"))));
  CHECK(name.starts_with("a-"));
  CHECK(run_name(plan_of(stack(2.0F, folder.file("b.npy")))) == name);
  CHECK(run_name(plan_of(stack(3.0F, folder.file("c.npy")))) != name);
}

TEST_CASE("whatever changes a run's result changes its name") {
  const TemporaryDirectory folder;
  const std::string recording = stack(2.0F, folder.file("a.npy"));
  write_file(folder.file("one.npz"), "one");
  write_file(folder.file("two.npz"), "two");
  write_file(folder.file("stamps.txt"), "1\n2\n");
  SensorModel sensor = sensor_preset("os1-16");
  sensor.beam_elevation_rad.back() -= 0.01;
  write_sensor_json(sensor, folder.file("sensor.json"));
  const auto reading = [](TablePlan& p) -> InputChoice& { return p.drives[0].recording; };
  const std::vector<std::function<void(TablePlan&)>> changes = {
      [](TablePlan&) {},
      [](TablePlan& p) { p.scans = 1; },
      [](TablePlan& p) { p.methods[0].source = "linear"; },
      [](TablePlan& p) { p.methods[0].source = "du-or"; },
      [&](TablePlan& p) { p.methods[0].source = folder.file("one.npz"); },
      [&](TablePlan& p) { p.methods[0].source = folder.file("two.npz"); },
      [&](TablePlan& p) { reading(p).row_order = "lowest-first"; },
      [&](TablePlan& p) { reading(p).capture = "corrected"; },
      [&](TablePlan& p) { reading(p).sensor = folder.file("sensor.json"); },
      [&](TablePlan& p) { reading(p).stamps = folder.file("stamps.txt"); },
      [&](TablePlan& p) {
        write_file(folder.file("stamps.txt"), "1\n3\n");
        reading(p).stamps = folder.file("stamps.txt");
      },
  };
  std::set<std::string> names;
  for (const auto& change : changes) {
    TablePlan plan = plan_of(recording);
    change(plan);
    names.insert(run_name(plan));
  }
  CHECK(names.size() == changes.size());
}

}  // namespace hqslam::tools
