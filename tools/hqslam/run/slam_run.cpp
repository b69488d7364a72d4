#include "run/slam_run.h"

#include <algorithm>

#include "timing/timing.h"

namespace hqslam::tools {

double scans_per_second(const SlamRun& run) {
  return run.wall_s > 0.0 ? static_cast<double>(run.scans.size()) / run.wall_s : 0.0;
}

ScanTimes scan_times(const SlamRun& run, std::string_view name,
                     const std::function<double(const ScanRecord&)>& seconds) {
  ScanTimes times{std::string(name), {}};
  for (const ScanRecord& scan : run.scans) times.times_ms.push_back(1e3 * seconds(scan));
  return times;
}

std::vector<ScanTimes> stage_times(const SlamRun& run) {
  std::vector<ScanTimes> times = {
      scan_times(run, "reading", [](const ScanRecord& scan) { return scan.reading_s; })};
  if (!run.upsampled_by.empty()) {
    times.push_back(
        scan_times(run, "upsampling", [](const ScanRecord& scan) { return scan.upsampling_s; }));
  }
  for (const Stage& stage : kStages) {
    times.push_back(scan_times(
        run, stage.name, [&](const ScanRecord& scan) { return scan.report.times.*stage.seconds; }));
  }
  return times;
}

ScanTimes slam_times(const SlamRun& run) {
  return scan_times(run, "slam_total",
                    [](const ScanRecord& scan) { return scan.report.times.total_s; });
}

std::vector<std::pair<slam::Status, std::int64_t>> status_counts(
    const SlamRun& run, slam::Status slam::ScanReport::*status) {
  std::vector<std::pair<slam::Status, std::int64_t>> counts;
  for (const slam::Status kind :
       {slam::Status::kOk, slam::Status::kTooFewFeatures, slam::Status::kDegenerate,
        slam::Status::kNotConverged, slam::Status::kAfterGap, slam::Status::kMapInDoubt,
        slam::Status::kNotRecognized}) {
    counts.emplace_back(kind, std::ranges::count(run.scans, kind, [&](const ScanRecord& scan) {
                          return scan.report.*status;
                        }));
  }
  return counts;
}

std::int64_t loops_closed(const SlamRun& run) {
  return std::ranges::count(run.loops, slam::LoopStatus::kClosed, &slam::LoopReport::status);
}

bool is_motion_known(const SlamRun& run, std::size_t scan) {
  const auto is_recognized = [&](std::size_t i) {
    return run.scans[i].report.mapping_status != slam::Status::kNotRecognized;
  };
  return is_recognized(scan) && is_recognized(scan + 1) &&
         run.segment_of_scan[scan] == run.segment_of_scan[scan + 1];
}

bool is_located(const SlamRun& run) {
  return std::ranges::any_of(run.scans, [](const ScanRecord& scan) {
    return scan.report.mapping_status != slam::Status::kNotRecognized;
  });
}

std::vector<std::int64_t> scan_of_pose(const SlamRun& run) {
  std::vector<std::int64_t> scans;
  for (const ScanRecord& record : run.scans) scans.push_back(record.scan);
  return scans;
}

double known_path_m(const SlamRun& run) {
  double path_m = 0.0;
  for (std::size_t i = 0; i + 1 < run.trajectory.size(); ++i) {
    if (!is_motion_known(run, i)) continue;
    path_m += (run.trajectory[i + 1].T_map_sensor.translation() -
               run.trajectory[i].T_map_sensor.translation())
                  .norm();
  }
  return path_m;
}

std::map<std::size_t, std::int64_t> scans_of_submaps(const SlamRun& run) {
  std::map<std::size_t, std::int64_t> result;
  for (const std::size_t part : run.submap_of_scan) ++result[part];
  return result;
}

}  // namespace hqslam::tools
