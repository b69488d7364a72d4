#include "run/run_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <system_error>

#include "hqslam/core/cloud_file.h"
#include "hqslam/core/error.h"
#include "hqslam/core/whole_file.h"
#include "hqslam/evaluation/trajectory_error.h"
#include "run/occupancy_grid.h"
#include "run/report_page.h"
#include "run/slam_settings.h"
#include "timing/timing.h"

namespace hqslam::tools {

std::string covariances_csv(const SlamRun& run) {
  constexpr const char* kAxes[] = {"x", "y", "z", "rx", "ry", "rz"};
  std::string text =
      "# covariance of e = (x y z rx ry rz) in T_true = T_map_sensor exp(e), in the sensor's "
      "frame, the first scan's pose being exact; m^2, m rad, rad^2; mapping: whether it was "
      "located; submap: relative poses between submaps are unknown\nstamp_s,mapping,submap";
  for (const char* row : kAxes) {
    for (const char* column : kAxes) text += fmt::format(",{}_{}", row, column);
  }
  text += '\n';
  for (std::size_t i = 0; i < run.scans.size(); ++i) {
    const ScanRecord& scan = run.scans[i];
    text += fmt::format("{:.9f},{},{}", scan.report.stamp_s, slam::name(scan.report.mapping_status),
                        run.submap_of_scan[i]);
    for (int row = 0; row < 6; ++row) {
      for (int column = 0; column < 6; ++column) {
        fmt::format_to(std::back_inserter(text), ",{:.6g}", scan.report.covariance(row, column));
      }
    }
    text += '\n';
  }
  return text;
}

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kCheckpointInterval_s = 5.0;
/// Largest share of the time that checkpoints may take: those of long drives are large.
constexpr double kCheckpointShare = 0.01;
constexpr std::array<const char*, 3> kResultsSoFar = {"trajectory.tum", "trajectory.kitti",
                                                      "timings.json"};
constexpr std::array<const char*, 5> kResultsAtTheEnd = {
    "covariances.csv", "map.pcd", "saved_map.npz", "corrected_sensor.json", "report.html"};

/// Whether the folder holds the results of an earlier run, which this one may replace.
bool written_by_hqslam(const fs::path& folder) {
  const std::string timings = folder / "timings.json";
  return has_marker(timings, R"("written_by": "hqslam run")") ||
         has_marker(timings, R"("written_by": "hqslam live")");
}

/// To microseconds: more digits are noise and make the file long.
double rounded(double value) { return std::round(value * 1e3) / 1e3; }

Json distribution_json(const std::vector<double>& values_ms) {
  const Statistics distribution = statistics_of(values_ms);
  return Json{{"median", rounded(distribution.median)},
              {"p95", rounded(distribution.p95)},
              {"max", rounded(distribution.max)},
              {"mean", rounded(distribution.mean)}};
}

/// Per stage one duration per scan.
std::vector<ScanTimes> durations_of(const SlamRun& run) {
  std::vector<ScanTimes> durations = stage_times(run);
  durations.push_back(slam_times(run));
  if (!run.scans.empty() && run.scans.front().latency_s) {
    durations.push_back(scan_times(
        run, "latency", [](const ScanRecord& scan) { return scan.latency_s.value_or(0.0); }));
  }
  for (ScanTimes& stage : durations) {
    std::ranges::transform(stage.times_ms, stage.times_ms.begin(), rounded);
  }
  return durations;
}

Json statuses_json(const SlamRun& run, slam::Status slam::ScanReport::*status) {
  Json json;
  for (const auto& [kind, scans] : status_counts(run, status)) {
    json[std::string(slam::name(kind))] = scans;
  }
  return json;
}

/// Places that were recognized, and by how much the pose moved.
Json loops_json(const SlamRun& run) {
  Json loops = Json::array();
  for (const slam::LoopReport& loop : run.loops) {
    loops.push_back(Json{{"scan", loop.scan},
                         {"older_scan", loop.older_scan},
                         {"status", slam::name(loop.status)},
                         {"correction_m", rounded(loop.correction_m)}});
  }
  return loops;
}

Json per_scan(const SlamRun& run, const std::vector<ScanTimes>& durations) {
  Json stamps = Json::array();
  Json odometry = Json::array();
  Json mapping = Json::array();
  for (const ScanRecord& scan : run.scans) {
    stamps.push_back(scan.report.stamp_s);
    odometry.push_back(slam::name(scan.report.odometry_status));
    mapping.push_back(slam::name(scan.report.mapping_status));
  }
  Json times;
  for (const auto& [stage, values_ms] : durations) times[stage] = values_ms;
  return Json{{"stamp_s", std::move(stamps)},
              {"odometry_status", std::move(odometry)},
              {"mapping_status", std::move(mapping)},
              {"times_ms", std::move(times)}};
}

}  // namespace

std::string timings_json(const SlamRun& run) {
  const std::vector<ScanTimes> durations = durations_of(run);
  Json statistics;
  for (const auto& [stage, values_ms] : durations) statistics[stage] = distribution_json(values_ms);
  std::int64_t invalid_points = 0;
  std::int64_t keyframes = 0;
  for (const ScanRecord& scan : run.scans) {
    invalid_points += scan.invalid_points;
    keyframes += scan.report.keyframe ? 1 : 0;
  }
  Json slam_options = Json::object();
  for (const auto& [option, value] : changed_options(run.slam)) slam_options[option] = value;
  const Json json = {
      {"written_by", "hqslam " + run.command},
      {"input", run.input},
      {"sensor", run.sensor.name},
      {"rows", run.sensor.rows()},
      {"columns", run.sensor.columns},
      {"upsampled_by", run.upsampled_by.empty() ? Json() : Json(run.upsampled_by)},
      {"located_in", run.located_in.empty() ? Json() : Json(run.located_in)},
      {"slam_options", std::move(slam_options)},
      {"threads", run.threads},
      {"end", name(run.end)},
      {"scans", run.scans.size()},
      {"scans_in_recording", run.scans_in_recording ? Json(*run.scans_in_recording) : Json()},
      {"wall_s", rounded(run.wall_s)},
      {"scans_per_second", rounded(scans_per_second(run))},
      {"keyframes", keyframes},
      {"invalid_points_dropped", invalid_points},
      {"scans_left_out", run.left_out.scans},
      {"left_out", run.left_out.each},
      {"parts_of_vehicle", run.own_parts.empty() ? Json() : Json(run.own_parts)},
      {"odometry_status", statuses_json(run, &slam::ScanReport::odometry_status)},
      {"mapping_status", statuses_json(run, &slam::ScanReport::mapping_status)},
      {"loops", loops_json(run)},
      {"times_ms", std::move(statistics)},
  };
  // File names need not be UTF-8: what is not is replaced instead of ending the run.
  std::string text = json.dump(2, ' ', false, Json::error_handler_t::replace);
  // The summary for people, the scans on one line for programs.
  text.resize(text.rfind("\n}"));
  return text + ",\n  \"per_scan\": " + per_scan(run, durations).dump() + "\n}\n";
}

RunOutput::RunOutput(const std::string& folder, const Paths& inputs) : folder_(folder) {
  if (fs::exists(folder_) && !fs::is_directory(folder_)) {
    throw Error("{}: expected a folder for the results, found a file; give another --out", folder);
  }
  const bool is_own = written_by_hqslam(folder_);
  constexpr const char* kBut = "was not written by hqslam";
  if (!is_own) {
    guard_dense_map(folder_, inputs);
    guard_occupancy_grid(folder_, inputs);
  }
  guard_results(folder_, kResultsSoFar, is_own, kBut, inputs);
  guard_results(folder_, kResultsAtTheEnd, is_own, kBut, inputs);
  guard_results(folder_, kDenseMapFiles, true, kBut, inputs);
  guard_results(folder_, kOccupancyGridFiles, true, kBut, inputs);
}

RunOutput::~RunOutput() {
  std::error_code ignored;
  if (made_folder_ && first_) fs::remove(folder_, ignored);  // only an empty one
}

void RunOutput::prepare() {
  if (lock_) return;
  made_folder_ = !fs::exists(folder_);
  make_result_folder(folder_);
  lock_.emplace(folder_);
}

bool RunOutput::checkpoint_due() const {
  const double wanted_s = std::max(kCheckpointInterval_s, last_duration_s_ / kCheckpointShare);
  return first_ || seconds_since(last_checkpoint_) >= wanted_s;
}

void RunOutput::write_checkpoint(const SlamRun& run) {
  const SteadyClock::time_point start = SteadyClock::now();
  last_checkpoint_ = start;  // also if it fails: it is not tried again at once
  prepare();
  // The timings first: they mark the folder as ours.
  write_text_file(timings_json(run), path("timings.json"));
  if (first_) {
    remove_results(folder_, kResultsAtTheEnd);
    remove_results(folder_, kDenseMapFiles);
    remove_results(folder_, kOccupancyGridFiles);
    first_ = false;
  }
  replace_file(path("trajectory.tum"),
               [&](const std::string& part) { write_tum(run.trajectory, part); });
  replace_file(path("trajectory.kitti"),
               [&](const std::string& part) { write_kitti_poses(run.trajectory, part); });
  last_checkpoint_ = SteadyClock::now();
  last_duration_s_ = seconds_since(start);
}

void RunOutput::write_results(const SlamRun& run) {
  write_checkpoint(run);
  write_text_file(covariances_csv(run), path("covariances.csv"));
  Scan map;
  map.points_m = run.map_points_m;
  map.intensity = run.map_intensity;
  replace_file(path("map.pcd"), [&](const std::string& part) { write_cloud(map, part); });
  if (run.saved_map) {
    replace_file(path("saved_map.npz"),
                 [&](const std::string& part) { slam::write_saved_map(part, *run.saved_map); });
  }
  if (run.found_beams) {
    write_text_file(sensor_json(run.found_beams->sensor), path("corrected_sensor.json"));
  }
  write_text_file(report_html(run), path("report.html"));
}

void RunOutput::write_occupancy_grid(const SlamRun& run, const slam::OccupancyMap& map) {
  tools::write_occupancy_grid(map, folder_);
  grid_ = thinned(map);
  write_text_file(report_html(run, nullptr, &*grid_), path("report.html"));
}

void RunOutput::write_dense_map(const SlamRun& run, const DenseMapRun& dense_map) {
  tools::write_dense_map(dense_map, folder_);
  write_text_file(report_html(run, &dense_map, grid_ ? &*grid_ : nullptr), path("report.html"));
}

}  // namespace hqslam::tools
