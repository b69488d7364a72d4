#include "run/slam_run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <omp.h>

#include <algorithm>
#include <set>

#include "hqslam/core/angles.h"
#include "hqslam/evaluation/trajectory_error.h"
#include "timing/timing.h"

namespace hqslam::tools {

namespace {

slam::Slam slam_of(const SensorModel& sensor, const slam::SlamOptions& options,
                   const std::optional<GivenMap>& map) {
  if (!map) return {sensor, options};
  return {sensor, options, map->map, map->T_map_level_start};
}

std::size_t largest_part(const SlamRun& run) {
  const std::map<std::size_t, std::int64_t> parts = scans_of_parts(run);
  const auto largest =
      std::ranges::max_element(parts, {}, [](const auto& part) { return part.second; });
  return largest == parts.end() ? 0 : largest->first;
}

/// "mapping: 198 scans ok, 2 degenerate; 1 loop closed"
std::string mapping_summary(const SlamRun& run) {
  std::vector<std::string> counts;
  for (const auto& [status, scans] : status_counts(run, &slam::ScanReport::mapping_status)) {
    if (scans > 0) {
      counts.push_back(
          fmt::format("{}{} {}", scans, counts.empty() ? " scans" : "", slam::name(status)));
    }
  }
  std::string summary = fmt::format("mapping: {}", fmt::join(counts, ", "));
  if (run.slam.loop_closing.enabled) {
    const std::int64_t closed = loops_closed(run);
    summary += fmt::format("; {} loop{} closed", closed, closed == 1 ? "" : "s");
  }
  const std::size_t parts = scans_of_parts(run).size();
  if (parts > 1) summary += fmt::format("; {} parts of the path, not joined", parts);
  return summary;
}

/// "inertial sensor: measured the way to 198 of 200 scans"; nothing where there is none
std::string inertial_summary(const SlamRun& run) {
  if (!run.has_imu) return "";
  const auto measured = std::ranges::count_if(
      run.scans, [](const ScanRecord& scan) { return scan.report.predicted_by_imu; });
  return fmt::format(
      "inertial sensor: measured the way to {} of {} scans{}\n", measured, run.scans.size(),
      2 * measured > std::ssize(run.scans)
          ? ""
          : "; between others its samples are missing, more than 50 ms apart, or hold no gravity");
}

/// "mounting: roll 0.1, pitch 12.0 degrees, estimated from the ground"; nothing of a level one
std::string mounting_summary(const SlamRun& run) {
  const slam::MountingOptions& mounted = run.mounting;
  const bool is_level = mounted.roll_rad == 0.0 && mounted.pitch_rad == 0.0;
  if (is_level && !run.slam.mounting.estimated) return "";
  const char* how = mounted.estimated             ? ", estimated from the ground"
                    : run.slam.mounting.estimated ? "; not estimated, no ground was found"
                                                  : "";
  return fmt::format("mounting: roll {:.1f}, pitch {:.1f} degrees{}\n",
                     kDegreesPerRadian * mounted.roll_rad, kDegreesPerRadian * mounted.pitch_rad,
                     how);
}

/// The median share of a scan's returns that lie on the ground; 1 where nothing was seen.
double median_ground_share(const SlamRun& run) {
  std::vector<double> shares;
  for (const ScanRecord& scan : run.scans) {
    if (scan.report.returns == 0) continue;
    shares.push_back(static_cast<double>(scan.report.ground_points) / scan.report.returns);
  }
  return shares.empty() ? 1.0 : distribution_of(shares).median;
}

/// Sensors on the road, on robots and in hands see a third of their returns and more on the ground,
/// one that hangs upside down and of which that was not said 5 to 9 %, rooms 5 %.
constexpr double kLittleGround = 0.1;

/// What a user may have forgotten to say; empty where enough ground was seen.
std::string ground_summary(const SlamRun& run) {
  const double share = median_ground_share(run);
  if (share >= kLittleGround) return "";
  return fmt::format(
      "ground: only {:.0f} % of what was seen; usual in rooms, elsewhere the sensor may lean or "
      "hang upside down: say so (mounting in hqslam slam-options)\n",
      100.0 * share);
}

/// Of which part of the map the maps are, if there are several.
std::string map_summary(const SlamRun& run) {
  const std::map<std::size_t, std::int64_t> parts = scans_of_parts(run);
  if (parts.size() < 2) return "";
  const std::int64_t scans = parts.at(run.map_part);
  return fmt::format(
      "maps: of part {} alone, {} scans; the {} of other parts are left out, for how they lie to "
      "it is not known\n",
      run.map_part, scans, std::ssize(run.scans) - scans);
}

}  // namespace

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
        slam::Status::kNotConverged, slam::Status::kAfterGap, slam::Status::kNotRecognized}) {
    counts.emplace_back(kind, std::ranges::count(run.scans, kind, [&](const ScanRecord& scan) {
                          return scan.report.*status;
                        }));
  }
  return counts;
}

std::int64_t loops_closed(const SlamRun& run) {
  return std::ranges::count(run.loops, slam::LoopStatus::kClosed, &slam::LoopReport::status);
}

bool is_way_known(const SlamRun& run, std::size_t scan) {
  const auto is_recognized = [&](std::size_t i) {
    return run.scans[i].report.mapping_status != slam::Status::kNotRecognized;
  };
  return is_recognized(scan) && is_recognized(scan + 1) &&
         run.segment_of_scan[scan] == run.segment_of_scan[scan + 1];
}

std::vector<std::int64_t> scan_of_pose(const SlamRun& run) {
  std::vector<std::int64_t> scans;
  for (const ScanRecord& record : run.scans) scans.push_back(record.scan);
  return scans;
}

double known_path_m(const SlamRun& run) {
  double path_m = 0.0;
  for (std::size_t i = 0; i + 1 < run.trajectory.size(); ++i) {
    if (!is_way_known(run, i)) continue;
    path_m += (run.trajectory[i + 1].T_map_sensor.translation() -
               run.trajectory[i].T_map_sensor.translation())
                  .norm();
  }
  return path_m;
}

std::map<std::size_t, std::int64_t> scans_of_parts(const SlamRun& run) {
  std::map<std::size_t, std::int64_t> result;
  for (const std::size_t part : run.part_of_scan) ++result[part];
  return result;
}

SlamSession::SlamSession(UpsampledInput& input, const slam::SlamOptions& options,
                         const std::optional<GivenMap>& map, bool keeps_scans)
    : input_(input),
      memory_(input.upsampler_or_null()),
      slam_(slam_of(input.seen(), options, map)),
      keeps_scans_(keeps_scans) {
  const SensorModel seen = input.seen();
  run_.input = input.recording.input;
  run_.sensor_name = seen.name;
  run_.rows = seen.rows();
  run_.columns = seen.columns;
  run_.measured_rows = seen.measured_rows;
  run_.upsampled_by = input.upsampler ? input.upsampler->name() : "";
  run_.slam = options;
  run_.threads = omp_get_max_threads();
  if (map) run_.located_in = map->path;
}

ScanRecord& SlamSession::process(const RecordedScan& scan, std::int64_t index, double reading_s,
                                 slam::ScanTrace* trace) {
  ScanRecord record;
  record.scan = index;
  record.reading_s = reading_s;
  record.invalid_points = scan.invalid_points;
  const OrganizedCloud measured = input_.measured(scan.cloud);
  record.upsampling_s = seconds_of([&] {
    cloud_ = input_.upsampled(measured, memory_.recall(measured, slam_.trajectory(), scan.stamp_s));
  });
  run_.has_imu = run_.has_imu || !scan.imu.empty();
  slam_.add_imu(scan.imu);
  record.report = slam_.process(cloud_, scan.stamp_s, trace);
  record.upsampling_s += seconds_of([&] {
    memory_.remember(measured, slam_.trajectory(),
                     slam::is_registered(record.report.mapping_status));
  });
  if (!input_.upsampler) record.upsampling_s = 0.0;
  remember(record.report.loop);
  if (keeps_scans_) kept_scans_.offer(run_.scans.size(), cloud_);
  run_.scans.push_back(std::move(record));
  run_.wall_s = seconds_since(start_);
  return run_.scans.back();
}

SlamRun& SlamSession::run_so_far() {
  run_.trajectory = slam_.trajectory();
  run_.segment_of_scan = slam_.segment_of_scan();
  return run_;
}

std::size_t SlamSession::parts() const {
  const std::vector<std::size_t> submaps = slam_.submap_of_scan();
  return std::set<std::size_t>(submaps.begin(), submaps.end()).size();
}

void SlamSession::remember(const slam::LoopReport& loop) {
  if (loop.status == slam::LoopStatus::kAgrees || loop.status == slam::LoopStatus::kClosed) {
    run_.loops.push_back(loop);
  }
}

SlamRun SlamSession::finished(bool save_map) {
  for (const slam::LoopReport& loop : slam_.finish()) remember(loop);
  run_.mounting = slam_.mounting();
  run_.part_of_scan = slam_.submap_of_scan();
  run_.segment_of_scan = slam_.segment_of_scan();
  run_.wall_s = seconds_since(start_);
  run_.trajectory = slam_.trajectory();
  for (const auto& [scan, covariance] : slam_.corrected_covariances()) {
    run_.scans[scan].report.covariance = covariance;
  }
  run_.map_part = largest_part(run_);
  run_.map_points_m = slam_.map_points_m(run_.map_part, &run_.map_intensity);
  run_.kept_scans = kept_scans_.take();
  if (save_map) run_.saved_map = slam_.saved_map();
  return std::move(run_);
}

std::string run_summary(const SlamRun& run) {
  std::string summary =
      fmt::format("{} scans, {:.1f} m of path, {:.1f} scans/s\n{}\n", run.scans.size(),
                  known_path_m(run), scans_per_second(run), mapping_summary(run));
  summary += map_summary(run);
  summary += inertial_summary(run);
  summary += mounting_summary(run);
  summary += ground_summary(run);
  if (!run.located_in.empty()) {
    const bool found = std::ranges::any_of(run.scans, [](const ScanRecord& scan) {
      return scan.report.mapping_status != slam::Status::kNotRecognized;
    });
    summary += found ? fmt::format("located in the map of {}\n", run.located_in)
                     : fmt::format("not located: no place of the map of {} was recognized\n",
                                   run.located_in);
  }
  if (!run.upsampled_by.empty()) {
    summary += fmt::format("upsampled to {} rows by {}: {:.1f} ms a scan (median)\n", run.rows,
                           run.upsampled_by, distribution_of(stage_times(run)[1].times_ms).median);
  }
  return summary;
}

std::string results_line(const SlamRun& run, const std::string& out) {
  return fmt::format(
      "results: {}/trajectory.tum, trajectory.kitti, covariances.csv, map.pcd, timings.json, "
      "report.html{}{}{}\n",
      out, run.saved_map ? ", saved_map.npz" : "",
      run.dense_map_summary.empty() ? ""
      : run.dense_map_las           ? ", dense_map.pcd, dense_map.ply, dense_map.las and pictures"
                                    : ", dense_map.pcd, dense_map.ply and pictures",
      run.occupancy_grid_summary.empty() ? "" : ", map.pgm, map.yaml");
}

}  // namespace hqslam::tools
