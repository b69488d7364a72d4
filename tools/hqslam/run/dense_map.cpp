#include "run/dense_map.h"

#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "commands.h"
#include "hqslam/core/error.h"
#include "recording/reference.h"
#include "run/occupancy_grid.h"
#include "run/slam_run.h"
#include "timing/timing.h"

namespace hqslam::tools {

ScanPoses poses_of(const SlamRun& run) {
  ScanPoses poses{run.trajectory, {}, {}, scan_of_pose(run)};
  for (std::size_t i = 0; i < run.scans.size(); ++i) {
    poses.is_located.push_back(slam::is_registered(run.scans[i].report.mapping_status) &&
                               run.part_of_scan[i] == run.map_part);
    if (i + 1 < run.scans.size()) poses.is_way_known.push_back(is_way_known(run, i));
  }
  return poses;
}

void declare_dense_map(Command& command, DenseMapChoice& choice,
                       const std::vector<const char*>& needs) {
  command
      .option("--map-voxel", &choice.options.voxel_m,
              "Of the dense map: metres from point to point",
              {.shows_default = true, .within = std::pair(0.02, 1.0), .needs = needs})
      .option("--map-confidence", &choice.options.least_confidence,
              "Of the dense map: least probability that a point is on a surface",
              {.shows_default = true, .within = std::pair(0.001, 0.999), .needs = needs})
      .option("--las", &choice.las, "Also write the dense map as dense_map.las", {.needs = needs});
}

DenseMapRun build_dense_map(const InputChoice& recording, const UpsamplingChoice& upsampling,
                            const ScanPoses& poses, const DenseMapChoice& choice,
                            const InterruptGuard& interrupt) {
  const SteadyClock::time_point start = SteadyClock::now();
  MapInput input(recording, upsampling, choice.options.voxel_m);
  slam::DenseMap map(choice.options);
  DenseMapRun run;
  static_cast<MapReading&>(run) = input.read_upsampled(
      poses, "dense map, points", interrupt,
      [&](const auto& scan, const auto& path) { map.insert(scan, input.measured_rows(), path); });
  input.read_measured(poses, "dense map, seen through", interrupt,
                      [&](const auto& scan, const auto& path) { map.see_through(scan, path); });
  run.points = map.points(&run.intensity);
  run.las = choice.las;
  run.voxel_m = choice.options.voxel_m;
  run.is_full = map.is_full();
  run.wall_s = seconds_since(start);
  return run;
}

namespace {

namespace fs = std::filesystem;

std::string no_scan_message(const DenseMapRun& run, const MapOptions& options) {
  if (run.without_pose == 0 && run.left_out.scans > 0) return run.left_out.text();
  return no_pose_message(options.poses, run.without_pose, options.input);
}

/// Poses of a survey count kilometres; 32-bit points cannot.
void check_near_origin(const ScanPoses& poses, const std::string& path) {
  constexpr double kFarthest_m = 1e5;
  for (const StampedPose& pose : poses.trajectory) {
    const double far_m = pose.T_map_sensor.translation().cwiseAbs().maxCoeff();
    if (far_m <= kFarthest_m) continue;
    throw Error(
        "{}: expected poses within {:.0f} km of their frame's origin, found one {:.0f} km away; "
        "subtract the first pose's position from all",
        path, 1e-3 * kFarthest_m, 1e-3 * far_m);
  }
}

}  // namespace

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
  // The .ply, by which the others are known as ours, comes first.
  for (const char* name : {"dense_map.ply", "dense_map.pcd", "dense_map.las"}) {
    if (!run.las && std::string_view(name).ends_with(".las")) continue;
    slam::write_dense_map(run.points, parts.add(folder / name), run.intensity);
  }
  parts.rename();
  if (!run.las) fs::remove(folder / "dense_map.las");  // of an earlier map
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

void declare(CLI::App& app, MapOptions& options) {
  Command command =
      add_command(app, "map", "The dense map of a recorded drive whose poses are known",
                  R"(Writes into --out, in the frame of the poses:
  dense_map.pcd, dense_map.ply   x y z, intensity where the recording has it,
                                 confidence, times_seen per voxel, binary
and with --occupancy-grid
  map.pgm, map.yaml              where a robot can drive, for Nav2
hqslam run --dense-map --occupancy-grid does the same with the poses that it finds.)");
  declare_input(command, options);
  declare_upsampling_method(command, options);
  command
      .option("--poses", &options.poses, kScanPosesHelp, {.required = true, .given = Given::kFile})
      .option("--out", &options.out, "Folder for the map; made if it is not there",
              {.required = true});
  declare_dense_map(command, options.map);
  declare_occupancy_grid(command, options.occupancy_grid, options.grid);
  declare_threads(command, options.threads);
}

int run(const MapOptions& options) {
  const InterruptGuard interrupt;
  use_threads(options.threads);
  options_of(options.grid);  // refused before the work, not after it
  refuse_to_write_into_recording(options.input, options.out);
  const ScanPoses poses = read_scan_poses(options.poses, interrupt,
                                          [&] { return upsampled_input(options, options).open(); });
  check_near_origin(poses, options.poses);
  const Paths inputs = {options.input, options.poses, options.upsample};
  guard_dense_map(options.out, inputs);
  if (options.occupancy_grid) guard_occupancy_grid(options.out, inputs);
  make_result_folder(options.out);
  const FolderLock lock(options.out);
  DenseMapRun run = build_dense_map(options, options, poses, options.map, interrupt);
  if (interrupt.stop_requested()) {
    to_stderr("hqslam: interrupted; no dense map was written\n");
    return kInterrupted;
  }
  if (run.scans == 0) throw Error(no_scan_message(run, options));
  write_dense_map(run, options.out);
  to_stdout("{}\nresults: {}/dense_map.pcd, dense_map.ply{}\n", dense_map_summary(run), options.out,
            run.las ? ", dense_map.las" : "");
  if (options.occupancy_grid) {
    const auto grid = build_occupancy_grid(options, options, poses, options.grid, interrupt);
    if (interrupt.stop_requested()) {
      to_stderr("hqslam: interrupted; no occupancy grid was written\n");
      return kInterrupted;
    }
    write_occupancy_grid(grid.map, options.out);
    to_stdout("{}\nresults: {}/map.pgm, map.yaml\n", grid.summary, options.out);
  }
  if (run.left_out.scans > 0) to_stderr("hqslam: {}\n", run.left_out.text());
  if (!run.end_message.empty()) {
    to_stderr("hqslam: {}; the map is of the scans before it\n", run.end_message);
    return kWrongInput;
  }
  return kOk;
}

}  // namespace hqslam::tools
