#include <string>

#include "hqslam/core/error.h"
#include "hqslam/slam/dense_map.h"
#include "product.h"
#include "recording/pose_check.h"
#include "recording/recording_choice.h"
#include "recording/scan_poses.h"
#include "run/dense_map.h"
#include "run/occupancy_grid.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

struct MapOptions : InputChoice, UpsamplingChoice {
  std::string poses;
  std::string out;
  int threads = 0;  ///< 0: what OpenMP chooses
  slam::DenseMapOptions map;
  bool occupancy_grid = false;
  OccupancyGridChoice grid;
};

std::string no_scan_message(const DenseMapRun& run, const MapOptions& options) {
  if (run.without_pose == 0 && run.left_out.scans > 0) return run.left_out.text();
  return no_pose_message(options.poses, run.without_pose, options.input);
}

/// Poses of a survey count kilometres; 32-bit points cannot.
void check_near_origin(const ScanPoses& poses, const std::string& path) {
  constexpr double kFarthestPose_m = 1e5;
  for (const StampedPose& pose : poses.trajectory) {
    const double far_m = pose.T_map_sensor.translation().cwiseAbs().maxCoeff();
    if (far_m <= kFarthestPose_m) continue;
    throw Error(
        "{}: expected poses within {:.0f} km of their frame's origin, found one {:.0f} km away; "
        "subtract the first pose's position from all",
        path, 1e-3 * kFarthestPose_m, 1e-3 * far_m);
  }
}

void declare(CLI::App& app, MapOptions& options) {
  Command command =
      add_command(app, "map", "Make a dense map of a recorded drive whose poses are known",
                  R"(Writes into --out, in the frame of the poses:
  dense_map.pcd, dense_map.ply   x y z, intensity where the recording has it,
                                 confidence, times_seen per voxel, binary
and with --occupancy-grid
  map.pgm, map.yaml              where a robot can drive, for Nav2
hqslam run --dense-map --occupancy-grid does the same with the poses that it finds.)");
  declare_input(command, options);
  declare_scans(command, options);
  declare_upsampling_method(command, options);
  command
      .option("--poses", &options.poses, kScanPosesHelp, {.required = true, .given = Given::kFile})
      .option("--out", &options.out, "Folder for the map; made if it does not exist",
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
  const auto opened = [&] {
    return std::make_unique<recordings::Recording>(
        std::move(upsampled_recording(options, options).recording));
  };
  const ScanPoses poses = read_scan_poses(options.poses, interrupt, opened);
  check_near_origin(poses, options.poses);
  warn_of_wrong_poses(poses, options.poses, interrupt, opened);
  const Paths inputs = {options.input, options.poses, options.upsample};
  guard_dense_map(options.out, inputs);
  if (options.occupancy_grid) guard_occupancy_grid(options.out, inputs);
  make_result_folder(options.out);
  const FolderLock lock(options.out);
  const DenseMapRun run = build_dense_map(options, options, poses, options.map, interrupt);
  if (interrupt.stop_requested()) {
    to_stderr("hqslam: interrupted; no dense map was written\n");
    return kInterrupted;
  }
  if (run.scans == 0) throw Error(no_scan_message(run, options));
  write_dense_map(run, options.out);
  to_stdout("{}\nresults: {}/dense_map.pcd, dense_map.ply\n", dense_map_summary(run), options.out);
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

}  // namespace

void add_map(CLI::App& app, Chosen& chosen) { add_subcommand<MapOptions>(app, chosen); }

}  // namespace hqslam::tools
