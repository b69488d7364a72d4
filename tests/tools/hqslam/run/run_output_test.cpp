#include "run/run_output.h"

#include <nlohmann/json.hpp>

#include "tools/example_run.h"

namespace hqslam::tools {
namespace {

const std::set<std::string> kAllResults = {"trajectory.tum", "trajectory.kitti", "covariances.csv",
                                           "map.pcd",        "timings.json",     "report.html"};

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::stringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

}  // namespace

TEST_CASE("the timings hold medians in milliseconds, counts of statuses and every scan") {
  SlamRun run = example_run(10);
  run.scans[4].report.odometry_status = slam::Status::kDegenerate;
  run.input = "bad \xFF name";
  const nlohmann::json json = nlohmann::json::parse(timings_json(run));
  CHECK(json["times_ms"]["features"]["median"] == doctest::Approx(2.0));
  CHECK(json["times_ms"]["slam_total"]["p95"] == doctest::Approx(10.0));
  CHECK(json["odometry_status"]["degenerate"] == 1);
  CHECK(json["odometry_status"]["ok"] == 9);
  CHECK(json["scans_per_second"] == doctest::Approx(50.0));
  CHECK(json["per_scan"]["times_ms"]["reading"].size() == 10);
  CHECK(json["per_scan"]["odometry_status"][4] == "degenerate");
}

TEST_CASE("the timings list the loops that were found") {
  SlamRun run = example_run(10);
  CHECK(nlohmann::json::parse(timings_json(run))["loops"].empty());
  run.loops = {{slam::LoopStatus::kClosed, 1, 7, 2, 3.25}, {slam::LoopStatus::kAgrees, 1, 9, 4, 0}};
  const nlohmann::json loops = nlohmann::json::parse(timings_json(run))["loops"];
  REQUIRE(loops.size() == 2);
  CHECK(loops[0]["scan"] == 7);
  CHECK(loops[0]["older_scan"] == 2);
  CHECK(loops[0]["status"] == "closed");
  CHECK(loops[0]["correction_m"] == doctest::Approx(3.25));
  CHECK(loops[1]["scan"] == 9);
  CHECK(loops[1]["status"] == "agrees");
}

TEST_CASE("upsampling is a stage of its own where there is any, and none where there is not") {
  SlamRun run = example_run(3);
  const nlohmann::json without = nlohmann::json::parse(timings_json(run));
  CHECK(without["upsampled_by"].is_null());
  CHECK_FALSE(without["times_ms"].contains("upsampling"));
  run.upsampled_by = "du-or";
  for (ScanRecord& scan : run.scans) scan.upsampling_s = 0.006;
  const nlohmann::json with = nlohmann::json::parse(timings_json(run));
  CHECK(with["upsampled_by"] == "du-or");
  CHECK(with["times_ms"]["upsampling"]["median"] == doctest::Approx(6.0));
  CHECK(with["times_ms"]["mapping"] == without["times_ms"]["mapping"]);
  CHECK(with["times_ms"]["slam_total"] == without["times_ms"]["slam_total"]);
}

TEST_CASE("the results are six files, and a checkpoint leaves nothing of an earlier run behind") {
  const TemporaryDirectory folder;
  const std::string out = folder.file("a/b");
  RunOutput(out).write_results(example_run(10));
  CHECK(names_in(out) == kAllResults);
  for (const char* map : {"dense_map.pcd", "dense_map.ply", "map.pgm", "map.yaml", "saved_map.npz",
                          "corrected_sensor.json"}) {
    write_file(folder.file("a/b/") + map, "of the earlier run");
  }
  RunOutput output(out);
  CHECK(names_in(out).size() == kAllResults.size() + 6);
  output.write_checkpoint(example_run(4));
  CHECK(names_in(out) ==
        std::set<std::string>{"trajectory.tum", "trajectory.kitti", "timings.json"});
  CHECK(read_tum(out + "/trajectory.tum").size() == 4);
}

TEST_CASE("the covariances are a line per scan: stamp, status, part and six rows of six") {
  SlamRun run = example_run(3);
  for (int i = 0; i < 36; ++i) run.scans[1].report.covariance(i / 6, i % 6) = 0.25 * i;
  run.scans[1].report.mapping_status = slam::Status::kTooFewFeatures;
  run.submap_of_scan[1] = 2;
  const std::vector<std::string> lines = split(covariances_csv(run), '\n');
  REQUIRE(lines.size() == 5);
  CHECK(lines[0].rfind("# covariance of e", 0) == 0);
  const std::vector<std::string> names = split(lines[1], ',');
  REQUIRE(names.size() == 39);
  CHECK(lines[1].starts_with("stamp_s,mapping,submap,x_x,"));
  CHECK(names[3 + 2 * 6 + 4] == "z_ry");
  CHECK(names[38] == "rz_rz");
  const std::vector<std::string> values = split(lines[3], ',');
  REQUIRE(values.size() == 39);
  CHECK(std::stod(values[0]) == doctest::Approx(run.scans[1].report.stamp_s));
  CHECK(values[1] == "too few features");
  CHECK(values[2] == "2");
  for (int i = 0; i < 36; ++i) CHECK(std::stod(values[i + 3]) == doctest::Approx(0.25 * i));
}

}  // namespace hqslam::tools
