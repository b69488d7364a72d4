#include "run/dense_map.h"

#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "hqslam/core/error.h"
#include "recording/reference.h"
#include "run/occupancy_grid.h"
#include "run/slam_run.h"
#include "timing/timing.h"

namespace hqslam::tools {

namespace fs = std::filesystem;

ScanPoses poses_of(const SlamRun& run) {
  ScanPoses poses{run.trajectory, {}, {}, scan_of_pose(run)};
  for (std::size_t i = 0; i < run.scans.size(); ++i) {
    poses.is_located.push_back(slam::is_registered(run.scans[i].report.mapping_status) &&
                               run.submap_of_scan[i] == run.largest_submap);
    if (i + 1 < run.scans.size()) poses.is_next_known.push_back(is_motion_known(run, i));
  }
  // Scans that a live run dropped are in its capture but not in the run: stamps are matched.
  if (!run.scans.empty() && run.scans.front().latency_s) poses.scan_of_pose.reset();
  return poses;
}

void declare_dense_map(Command& command, slam::DenseMapOptions& options,
                       const std::vector<const char*>& needs) {
  command
      .option("--map-voxel", &options.voxel_m, "Voxel size of the dense map, metres",
              {.shows_default = true, .within = std::pair(0.02, 1.0), .needs = needs})
      .option("--map-confidence", &options.least_confidence,
              "Least probability that a point of the dense map is on a surface",
              {.shows_default = true, .within = std::pair(0.001, 0.999), .needs = needs});
}

DenseMapRun build_dense_map(const InputChoice& recording, const UpsamplingChoice& upsampling,
                            const ScanPoses& poses, const slam::DenseMapOptions& options,
                            const InterruptGuard& interrupt) {
  const SteadyClock::time_point start = SteadyClock::now();
  MapInput input(recording, upsampling, options.voxel_m);
  slam::DenseMap map(options);
  DenseMapRun run;
  static_cast<MapReading&>(run) = input.read_upsampled(
      poses, "dense map, points", interrupt,
      [&](const auto& scan, const auto& path) { map.insert(scan, input.measured_rows(), path); });
  input.read_measured(poses, "dense map, seen through", interrupt,
                      [&](const auto& scan, const auto& path) { map.see_through(scan, path); });
  run.points = map.points(&run.intensity);
  run.voxel_m = options.voxel_m;
  run.is_full = map.is_full();
  run.wall_s = seconds_since(start);
  return run;
}

void guard_dense_map(const fs::path& folder, const Paths& inputs) {
  const auto is_own = [&](const char* name) {
    return has_marker((folder / name).string(), "written by hqslam");
  };
  guard_results(folder, kDenseMapFiles, is_own("dense_map.ply"),
                "there is no dense map of hqslam beside it", inputs);
  if (fs::exists(folder / "dense_map.pcd") && !is_own("dense_map.pcd")) {
    guard_results(folder, {kDenseMapFiles, 1}, false, "was not written by hqslam", inputs);
  }
}

void write_dense_map(const DenseMapRun& run, const fs::path& folder) {
  make_result_folder(folder);
  PartFiles parts;  // an earlier map stays until all of this one is there
  for (const char* name : {"dense_map.ply", "dense_map.pcd"}) {
    slam::write_dense_map(run.points, parts.add(folder / name), run.intensity);
  }
  parts.rename();
}

std::string dense_map_summary(const DenseMapRun& run) {
  std::string summary = fmt::format("dense map: {} points, one per {} m, of {} scans, {:.1f} s",
                                    run.points.size(), run.voxel_m, run.scans, run.wall_s);
  if (run.without_pose > 0) {
    summary += fmt::format("; {} scans without a pose left out", run.without_pose);
  }
  if (run.is_full) summary += "; full: give a larger --map-voxel for the rest";
  return summary;
}

}  // namespace hqslam::tools
