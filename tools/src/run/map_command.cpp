#include "run/map_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <numeric>
#include <utility>

#include "files/result_folder.h"
#include "hqslam/core/error.h"
#include "lift/lifted_input.h"
#include "recording/recording_sensor.h"
#include "recording/reference.h"
#include "run/dense_map_output.h"
#include "terminal/exit_status.h"
#include "terminal/interrupt.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

ScanPoses poses_from(const MapOptions& options) {
  const std::string& path = options.poses;
  const TrajectoryFile file = read_trajectory_file(path);
  if (file.has_stamps) return {file.poses, {}, {}, std::nullopt};
  const std::int64_t scans = scans_in(options, *lifted_input(options, options).open());
  if (std::ssize(file.poses) != scans) {
    throw Error(fmt::format(
        "{}: has {} poses without stamps, but the recording has {} scans; give one pose per scan "
        "or a TUM file",
        path, file.poses.size(), scans));
  }
  std::vector<std::int64_t> every_scan(file.poses.size());
  std::iota(every_scan.begin(), every_scan.end(), 0);
  return {file.poses, {}, {}, std::move(every_scan)};
}

std::string no_scan_message(const DenseMapRun& run, const MapOptions& options) {
  if (run.scans_left_out == 0 && run.not_understood.scans > 0) return run.not_understood.text();
  return fmt::format(
      "{}: none of its poses is within 0.02 s of one of {} scans of {}; give poses with the stamps "
      "of the scans",
      options.poses, run.scans_left_out, options.input);
}

}  // namespace

std::string dense_map_summary(const DenseMapRun& run) {
  std::string summary = fmt::format("dense map: {} points, one per {} m, of {} scans, {:.1f} s",
                                    run.points.size(), run.voxel_m, run.scans, run.wall_s);
  if (run.scans_left_out > 0) {
    summary += fmt::format("; {} scans without a pose left out", run.scans_left_out);
  }
  if (run.is_full) summary += "; full: give a larger --map-voxel for the rest";
  return summary;
}

void declare_map(CLI::App& app, MapOptions& options) {
  CLI::App* command =
      app.add_subcommand("map", "The dense map of a recorded drive whose poses are known");
  declare_input(*command, options);
  declare_lifting(*command, options);
  command
      ->add_option("--poses", options.poses,
                   "Where the scans were taken: TUM, matched by stamp (0.02 s), scans without a "
                   "pose are left out; or KITTI with one pose per scan")
      ->required()
      ->check(CLI::ExistingFile);
  command->add_option("--out", options.out, "Folder for the map; made if it is not there")
      ->required();
  declare_dense_map(*command, options.map);
  declare_threads(*command, options.threads);
  command->footer(
      "Writes into --out, in the frame of the poses:\n"
      "  dense_map.pcd, dense_map.ply   x y z confidence times_seen per voxel, binary\n"
      "  dense_map_above.png, dense_map_perspective.png\n"
      "hqslam run --dense-map does the same with the poses that it finds.");
}

int map_command(const MapOptions& options) {
  const InterruptGuard interrupt;
  use_threads(options.threads);
  refuse_to_write_into_recording(options.input, options.out);
  const ScanPoses poses = poses_from(options);
  guard_dense_map(options.out, {options.input, options.poses, options.upsample});
  make_result_folder(options.out);
  const FolderLock lock(options.out);
  const DenseMapRun run = build_dense_map(options, options, poses, options.map, interrupt);
  if (interrupt.stop_requested()) {
    to_stderr("hqslam: interrupted; no dense map was written\n");
    return kInterrupted;
  }
  if (run.scans == 0) throw Error(no_scan_message(run, options));
  write_dense_map(run, pictures_of(run, poses.trajectory), options.out);
  to_stdout(
      "{}\nresults: {}/dense_map.pcd, dense_map.ply, dense_map_above.png, "
      "dense_map_perspective.png\n",
      dense_map_summary(run), options.out);
  if (run.not_understood.scans > 0) to_stderr("hqslam: {}\n", run.not_understood.text());
  if (!run.end_message.empty()) {
    to_stderr("hqslam: {}; the map is of the scans before it\n", run.end_message);
    return kWrongInput;
  }
  return kOk;
}

}  // namespace hqslam::tools
