#include "run/run_summary.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "hqslam/core/angles.h"
#include "hqslam/evaluation/trajectory_error.h"
#include "run/beam_correction.h"

namespace hqslam::tools {
namespace {

/// "mapping: 198 scans ok, 2 degenerate; 1 loop closed"
std::string mapping_summary(const SlamRun& run) {
  std::vector<std::string> counts;
  for (const auto& [status, scans] : status_counts(run, &slam::ScanReport::mapping_status)) {
    if (scans > 0) {
      const char* unit = !counts.empty() ? "" : scans == 1 ? " scan" : " scans";
      counts.push_back(fmt::format("{}{} {}", scans, unit, slam::name(status)));
    }
  }
  std::string summary = fmt::format("mapping: {}", fmt::join(counts, ", "));
  if (run.slam.loop_closing.enabled) {
    const std::int64_t closed = loops_closed(run);
    summary += fmt::format("; {} loop{} closed", closed, closed == 1 ? "" : "s");
  }
  const std::size_t submaps = scans_of_submaps(run).size();
  if (submaps > 1) summary += fmt::format("; {} submaps, not joined", submaps);
  return summary;
}

/// Why most scans were not predicted by an inertial sensor that nothing contradicted.
std::string why_not_predicted(const SlamRun& run) {
  constexpr double kFewest_per_s = 20.0;  // as slam/src/imu/imu_buffer.cpp: 50 ms apart at most
  const double duration_s =
      run.trajectory.empty() ? 0.0 : run.trajectory.back().stamp_s - run.trajectory.front().stamp_s;
  const double per_s = static_cast<double>(run.imu_samples) / duration_s;
  if (per_s < kFewest_per_s) {
    return fmt::format("it has {:.3g} samples a second, SLAM uses {:.0f} or more", per_s,
                       kFewest_per_s);
  }
  return "not used otherwise: samples are missing, or the scans turned too little to verify "
         "it";
}

/// "inertial sensor: predicted 198 of 200 scans"; nothing where there is none
std::string inertial_summary(const SlamRun& run) {
  if (run.imu_samples == 0) return "";
  const auto predicted = std::ranges::count_if(
      run.scans, [](const ScanRecord& scan) { return scan.report.predicted_by_imu; });
  const std::string reason =
      !run.imu_complaint.empty()              ? "; not used otherwise: " + run.imu_complaint
      : 2 * predicted > std::ssize(run.scans) ? ""
                                              : "; " + why_not_predicted(run);
  return fmt::format("inertial sensor: predicted {} of {} scans{}\n", predicted, run.scans.size(),
                     reason);
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

/// A mounting that the user may have forgotten; empty where enough ground was seen.
std::string ground_summary(const SlamRun& run) {
  std::vector<double> shares;
  for (const ScanRecord& scan : run.scans) {
    if (scan.report.returns > 0) shares.push_back(share_on_ground(scan.report));
  }
  const std::string complaint = complaint_about_ground(shares);
  return complaint.empty() ? "" : "ground: " + complaint + "\n";
}

/// "fog, dust or snow: near echoes left out of 190 scans; ..."; nothing in clear air.
std::string scattered_summary(const SlamRun& run) {
  const auto scans = std::ranges::count_if(
      run.scans, [](const ScanRecord& scan) { return scan.report.scattered > 0; });
  if (scans == 0) return "";
  return fmt::format(
      "fog, dust or snow: near echoes left out of {} scans, from which beams are not calibrated: "
      "where they are off, height and tilt drift by more than stated\n",
      scans);
}

/// The submap of the maps, if there are several.
std::string map_summary(const SlamRun& run) {
  const std::map<std::size_t, std::int64_t> submaps = scans_of_submaps(run);
  if (submaps.size() < 2) return "";
  const std::int64_t scans = submaps.at(run.largest_submap);
  return fmt::format(
      "maps: of submap {} alone, {} scans; the {} of other submaps are left out, because their "
      "poses relative to it are unknown\n",
      run.largest_submap, scans, std::ssize(run.scans) - scans);
}

/// Sensors on the road, on robots and in hands see a quarter of their returns and more on the
/// ground; one that hangs upside down or whose rows are in reverse order 0 to 14 % without being
/// stated; rooms 5 %.
constexpr double kLittleGround = 0.18;

/// Of a drive in a saved map: whether it was located there, and whether scans fit the map.
std::string location_summary(const SlamRun& run) {
  if (run.located_in.empty()) return "";
  if (!is_located(run)) {
    return fmt::format("not located: no place of the map of {} was recognized\n", run.located_in);
  }
  const std::int64_t doubted = std::ranges::count_if(run.scans, [](const ScanRecord& scan) {
    return scan.report.mapping_status == slam::Status::kMapInDoubt;
  });
  std::string doubt;
  if (2 * doubted > std::ssize(run.scans)) {
    doubt = fmt::format(
        ", in doubt: {} of {} scans fit it far less than those of its own drive did; it is of "
        "another place, or much has changed",
        doubted, run.scans.size());
  }
  return fmt::format("located in the map of {}{}\n", run.located_in, doubt);
}

}  // namespace

double share_on_ground(const slam::ScanReport& report) {
  return static_cast<double>(report.ground_points) / report.returns;
}

std::string complaint_about_ground(const std::vector<double>& shares) {
  if (shares.empty()) return "";
  const double share = statistics_of(shares).median;
  if (share >= kLittleGround) return "";
  return fmt::format(
      "only {:.0f} % of the returns; normal in rooms. Elsewhere height and tilt drift, and the "
      "sensor may lean or hang upside down (state it: mounting in hqslam slam-options), or a "
      "stack's rows be in reverse order (--row-order)",
      100.0 * share);
}

std::string run_summary(const SlamRun& run) {
  std::string summary =
      fmt::format("{} scans, {:.1f} m of path, {:.1f} scans/s\n{}\n", run.scans.size(),
                  known_path_m(run), scans_per_second(run), mapping_summary(run));
  summary += map_summary(run);
  summary += inertial_summary(run);
  summary += mounting_summary(run);
  summary += ground_summary(run);
  summary += scattered_summary(run);
  if (!run.own_parts.empty()) {
    summary += fmt::format("parts of the vehicle: {}; left out\n", run.own_parts);
  }
  if (run.found_beams) {
    summary += fmt::format("beams: {}; {}\n", beams_text(*run.found_beams),
                           run.command == "live"
                               ? "not corrected here: give corrected_sensor.json as --sensor"
                               : "corrected");
  }
  summary += location_summary(run);
  if (!run.upsampled_by.empty()) {
    summary +=
        fmt::format("upsampled to {} rows by {}: {:.1f} ms a scan (median)\n", run.sensor.rows(),
                    run.upsampled_by, statistics_of(stage_times(run)[1].times_ms).median);
  }
  return summary;
}

std::string results_lines(const SlamRun& run, const std::string& out) {
  std::string lines;
  for (const std::string& map : {run.dense_map_summary, run.occupancy_grid_summary}) {
    if (!map.empty()) lines += map + "\n";
  }
  lines += fmt::format(
      "results: {}/trajectory.tum, trajectory.kitti, covariances.csv, map.pcd, timings.json, "
      "report.html{}{}{}{}\n",
      out, run.found_beams ? ", corrected_sensor.json" : "", run.saved_map ? ", saved_map.npz" : "",
      run.dense_map_summary.empty() ? "" : ", dense_map.pcd, dense_map.ply",
      run.occupancy_grid_summary.empty() ? "" : ", map.pgm, map.yaml");
  return lines;
}

}  // namespace hqslam::tools
