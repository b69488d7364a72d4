#include "run_output.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "covariances_csv.h"
#include "dense_map_output.h"
#include "hqslam/core/error.h"
#include "hqslam/core/pcd.h"
#include "report/html_report.h"
#include "result_folder.h"
#include "timing_statistics.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kCheckpointInterval_s = 5.0;
constexpr const char* kWrittenBy = "hqslam run";
constexpr std::array<const char*, 6> kResultNames = {"trajectory.tum",  "trajectory.kitti",
                                                     "covariances.csv", "map.pcd",
                                                     "timings.json",    "report.html"};

/// Whether the folder holds the results of an earlier run, which this one may replace.
bool written_by_hqslam(const fs::path& folder) {
  std::ifstream stream(folder / "timings.json");
  const Json json = Json::parse(stream, nullptr, /*allow_exceptions=*/false);
  return json.is_object() && json.value("written_by", Json()) == kWrittenBy;
}

void write_text(const std::string& text, const std::string& path) {
  std::ofstream stream(path, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) {
    throw Error(fmt::format("{}: cannot be written; is the disk full?", path));
  }
}

double milliseconds(double seconds) { return 1e3 * seconds; }

/// To microseconds: more digits are noise and make the file long.
double rounded(double value) { return std::round(value * 1e3) / 1e3; }

Json distribution_json(const std::vector<double>& values_ms) {
  const Distribution distribution = distribution_of(values_ms);
  return Json{{"median", rounded(distribution.median)},
              {"p95", rounded(distribution.p95)},
              {"max", rounded(distribution.max)},
              {"mean", rounded(distribution.mean)}};
}

using Durations_ms = std::vector<std::pair<std::string, std::vector<double>>>;

/// Per stage one duration per scan.
Durations_ms durations_of(const SlamRun& run) {
  const std::size_t before_slam = run.upsampled_by.empty() ? 1 : 2;
  Durations_ms durations = {{"reading", {}}};
  if (!run.upsampled_by.empty()) {
    durations.emplace_back("upsampling", std::vector<double>());
  }
  for (const Stage& stage : kStages) {
    durations.emplace_back(stage.name, std::vector<double>());
  }
  durations.emplace_back("slam_total", std::vector<double>());
  for (const ScanRecord& scan : run.scans) {
    durations.front().second.push_back(rounded(milliseconds(scan.reading_s)));
    if (!run.upsampled_by.empty()) {
      durations[1].second.push_back(rounded(milliseconds(scan.upsampling_s)));
    }
    for (std::size_t i = 0; i < kStages.size(); ++i) {
      durations[i + before_slam].second.push_back(
          rounded(milliseconds(scan.report.times.*kStages[i].seconds)));
    }
    durations.back().second.push_back(rounded(milliseconds(scan.report.times.total_s)));
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

/// Places that were recognised, and by how much the pose moved.
Json loops_json(const SlamRun& run) {
  Json loops = Json::array();
  for (std::size_t scan = 0; scan < run.scans.size(); ++scan) {
    const slam::LoopReport& loop = run.scans[scan].report.loop;
    if (loop.status != slam::LoopStatus::kAgrees && loop.status != slam::LoopStatus::kClosed) {
      continue;
    }
    loops.push_back(Json{{"scan", scan},
                         {"older_scan", loop.older_scan},
                         {"status", slam::name(loop.status)},
                         {"correction_m", rounded(loop.correction_m)}});
  }
  return loops;
}

Json per_scan(const SlamRun& run, const Durations_ms& durations) {
  Json stamps = Json::array();
  Json odometry = Json::array();
  Json mapping = Json::array();
  for (const ScanRecord& scan : run.scans) {
    stamps.push_back(scan.report.stamp_s);
    odometry.push_back(slam::name(scan.report.odometry_status));
    mapping.push_back(slam::name(scan.report.mapping_status));
  }
  Json times;
  for (const auto& [stage, values_ms] : durations) {
    times[stage] = values_ms;
  }
  return Json{{"stamp_s", std::move(stamps)},
              {"odometry_status", std::move(odometry)},
              {"mapping_status", std::move(mapping)},
              {"times_ms", std::move(times)}};
}

}  // namespace

std::string timings_json(const SlamRun& run) {
  const Durations_ms durations = durations_of(run);
  Json statistics;
  for (const auto& [stage, values_ms] : durations) {
    statistics[stage] = distribution_json(values_ms);
  }
  std::int64_t invalid_points = 0;
  std::int64_t key_frames = 0;
  for (const ScanRecord& scan : run.scans) {
    invalid_points += scan.invalid_points;
    key_frames += scan.report.key_frame ? 1 : 0;
  }
  const Json json = {
      {"written_by", kWrittenBy},
      {"input", run.input},
      {"sensor", run.sensor_name},
      {"rows", run.rows},
      {"columns", run.columns},
      {"upsampled_by", run.upsampled_by.empty() ? Json() : Json(run.upsampled_by)},
      {"threads", run.threads},
      {"end", name(run.end)},
      {"scans", run.scans.size()},
      {"scans_in_recording", run.scans_in_recording},
      {"wall_s", rounded(run.wall_s)},
      {"scans_per_second", rounded(scans_per_second(run))},
      {"key_frames", key_frames},
      {"invalid_points_dropped", invalid_points},
      {"scans_left_out", run.left_out.scans},
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

RunOutput::RunOutput(const std::string& folder)
    : folder_(folder), last_checkpoint_(std::chrono::steady_clock::now()) {
  if (fs::exists(folder_) && !fs::is_directory(folder_)) {
    throw Error(fmt::format(
        "{}: expected a folder for the results, found a file; give another --out", folder));
  }
  if (written_by_hqslam(folder_)) {
    return;
  }
  refuse_foreign_dense_map(folder_);
  for (const char* result : kResultNames) {
    if (fs::exists(folder_ / result)) {
      throw Error(fmt::format(
          "{}: is there already and was not written by hqslam run; give another --out or move it",
          (folder_ / result).string()));
    }
  }
}

bool RunOutput::checkpoint_due() const {
  const auto since = std::chrono::steady_clock::now() - last_checkpoint_;
  return first_ || std::chrono::duration<double>(since).count() >= kCheckpointInterval_s;
}

void RunOutput::write_file(const std::string& name,
                           const std::function<void(const std::string&)>& write) {
  const fs::path part = folder_ / (name + ".part");
  std::error_code error;
  try {
    write(part.string());
  } catch (const Error&) {
    fs::remove(part, error);
    throw;
  }
  fs::rename(part, folder_ / name, error);
  if (error) {
    throw Error(fmt::format("{}: cannot be written ({}); give another --out",
                            (folder_ / name).string(), error.message()));
  }
}

void RunOutput::write_checkpoint(const SlamRun& run) {
  make_result_folder(folder_);
  // The timings first: they mark the folder as ours.
  write_file("timings.json", [&](const std::string& path) { write_text(timings_json(run), path); });
  if (first_) {
    std::error_code ignored;
    fs::remove(folder_ / "covariances.csv", ignored);
    fs::remove(folder_ / "map.pcd", ignored);
    fs::remove(folder_ / "report.html", ignored);
    remove_dense_map(folder_);
    first_ = false;
  }
  write_file("trajectory.tum", [&](const std::string& path) { write_tum(run.trajectory, path); });
  write_file("trajectory.kitti",
             [&](const std::string& path) { write_kitti_poses(run.trajectory, path); });
  last_checkpoint_ = std::chrono::steady_clock::now();
}

void RunOutput::write_results(const SlamRun& run,
                              const std::optional<ReferenceComparison>& comparison) {
  write_checkpoint(run);
  write_file("covariances.csv",
             [&](const std::string& path) { write_text(covariances_csv(run), path); });
  write_file("map.pcd", [&](const std::string& path) { write_pcd(run.map_points_m, path); });
  write_file("report.html",
             [&](const std::string& path) { write_text(html_report(run, comparison), path); });
}

void RunOutput::write_dense_map(const SlamRun& run,
                                const std::optional<ReferenceComparison>& comparison,
                                const DenseMapRun& dense_map) {
  const DenseMapPictures pictures = pictures_of(dense_map, run.trajectory);
  tools::write_dense_map(dense_map, pictures, folder_);
  write_file("report.html", [&](const std::string& path) {
    write_text(html_report(run, comparison, {&dense_map, &pictures}), path);
  });
}

}  // namespace hqslam::tools
