#include "run/dense_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <system_error>
#include <utility>

#include "commands.h"
#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "lift/drive_memory.h"
#include "lift/lifted_input.h"
#include "recording/recording_choice.h"
#include "recording/reference.h"
#include "report/cloud_picture.h"
#include "run/slam_run.h"
#include "terminal/command_options.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"
#include "timing/timing.h"

namespace hqslam::tools {

namespace {

/// One reading of all scans whose pose may be known.
struct MapReading : Reading {
  std::int64_t scans = 0;         ///< with a pose that is known
  std::int64_t without_pose = 0;  ///< the others
};

/// Calls use(scan, path) for every scan whose pose is known.
MapReading read_all(LiftedInput& input, const ScanPoses& poses, const std::string& label,
                    const InterruptGuard& interrupt,
                    const std::function<void(const RecordedScan&, const slam::SensorPath&)>& use) {
  const auto source = input.open();
  const auto& scans = poses.scan_of_pose;
  std::optional<std::int64_t> most = source->size();
  if (scans && !scans->empty()) {
    most = std::min(most.value_or(scans->back() + 1), scans->back() + 1);
  }
  Progress progress(label, most);
  MapReading reading;
  read_scans(*source, interrupt, reading, [&](const ReadScan& read) {
    if (const auto path = poses.path_of(read.index, read.scan.stamp_s)) {
      use(read.scan, *path);
      ++reading.scans;
    } else {
      ++reading.without_pose;
    }
    progress.update(read.index + 1, source->read_share());
    return !most || read.index + 1 < *most;
  });
  progress.finish();
  return reading;
}

}  // namespace

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
      .option("--map-voxel", &choice.voxel_m, "Of the dense map: metres from point to point",
              {.shows_default = true, .within = std::pair(0.02, 1.0), .needs = needs})
      .option("--map-confidence", &choice.least_confidence,
              "Of the dense map: least probability that a point is on a surface",
              {.shows_default = true, .within = std::pair(0.001, 0.999), .needs = needs});
}

DenseMapRun build_dense_map(const InputChoice& recording, const LiftingChoice& lifting,
                            const ScanPoses& poses, const DenseMapChoice& choice,
                            const InterruptGuard& interrupt) {
  const SteadyClock::time_point start = SteadyClock::now();
  nn::SuperResolverOptions network;
  network.tolerance_m = static_cast<float>(choice.voxel_m);
  network.least_confidence = slam::DenseMapOptions::kLeastPointConfidence;
  LiftedInput input = lifted_input(recording, {lifting.upsample, lifting.rows}, network);
  slam::DenseMapOptions options;
  options.voxel_m = choice.voxel_m;
  options.least_confidence = choice.least_confidence;
  slam::DenseMap map(options);
  const std::optional<RowSelection> computed_from = input.upsampler
                                                        ? input.upsampler->measured_rows()
                                                    : input.rows ? std::nullopt
                                                                 : input.recorded.measured_rows;
  DriveMemory memory(input.lifter());
  const MapReading inserted = read_all(
      input, poses, "dense map, points", interrupt,
      [&](const RecordedScan& scan, const auto& path) {
        const OrganizedCloud measured = input.measured(scan.cloud);
        map.insert(input.lifted(measured, memory.recall_and_remember(measured, path, scan.stamp_s)),
                   computed_from, path);
      });
  read_all(input, poses, "dense map, seen through", interrupt,
           [&](const RecordedScan& scan, const auto& path) {
             const OrganizedCloud cloud = input.measured(scan.cloud);
             const bool all_measured = input.upsampler || !computed_from;
             map.see_through(all_measured ? cloud : select_rows(cloud, *computed_from), path);
           });
  DenseMapRun run;
  run.points = map.points();
  run.voxel_m = choice.voxel_m;
  run.scans = inserted.scans;
  run.scans_left_out = inserted.without_pose;
  run.not_understood = inserted.left_out;
  run.is_full = map.is_full();
  run.end_message = inserted.end_message;
  run.wall_s = seconds_since(start);
  return run;
}

namespace {

namespace fs = std::filesystem;

constexpr int kPictureColumns = 1600;
constexpr int kAboveRows = 1200;
constexpr int kPerspectiveRows = 900;

}  // namespace

DenseMapPictures pictures_of(const DenseMapRun& run, const Trajectory& path) {
  std::vector<Eigen::Vector3f> points_m;
  points_m.reserve(run.points.size());
  for (const slam::DenseMapPoint& point : run.points) points_m.push_back(point.point_m);
  const CloudScene scene{points_m, path, run.voxel_m};
  return {cloud_from_above(scene, kAboveRows, kPictureColumns),
          cloud_in_perspective(scene, kPerspectiveRows, kPictureColumns)};
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

void remove_dense_map(const fs::path& folder) {
  std::error_code ignored;
  // The .ply, by which the others are known as ours, goes last.
  for (const char* name :
       {kDenseMapFiles[0], kDenseMapFiles[2], kDenseMapFiles[3], kDenseMapFiles[1]}) {
    fs::remove(folder / name, ignored);
    fs::remove(folder / (std::string(name) + ".part"), ignored);  // of a run that was killed
  }
}

void write_dense_map(const DenseMapRun& run, const DenseMapPictures& pictures,
                     const fs::path& folder) {
  make_result_folder(folder);
  PartFiles parts;  // an earlier map stays until all of this one is there
  // The .ply, by which the others are known as ours, comes first.
  slam::write_dense_map_ply(run.points, parts.add(folder / "dense_map.ply"));
  slam::write_dense_map_pcd(run.points, parts.add(folder / "dense_map.pcd"));
  write_png(pictures.above, parts.add(folder / "dense_map_above.png"));
  write_png(pictures.perspective, parts.add(folder / "dense_map_perspective.png"));
  parts.rename();
}

namespace {

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
  Command command =
      add_command(app, "map", "The dense map of a recorded drive whose poses are known",
                  "Writes into --out, in the frame of the poses:\n"
                  "  dense_map.pcd, dense_map.ply   x y z confidence times_seen per voxel, binary\n"
                  "  dense_map_above.png, dense_map_perspective.png\n"
                  "hqslam run --dense-map does the same with the poses that it finds.");
  declare_input(command, options);
  declare_lifting(command, options);
  command
      .option("--poses", &options.poses, kScanPosesHelp, {.required = true, .given = Given::kFile})
      .option("--out", &options.out, "Folder for the map; made if it is not there",
              {.required = true});
  declare_dense_map(command, options.map);
  declare_threads(command, options.threads);
}

int map_command(const MapOptions& options) {
  const InterruptGuard interrupt;
  use_threads(options.threads);
  refuse_to_write_into_recording(options.input, options.out);
  const ScanPoses poses = read_scan_poses(
      options.poses, [&] { return scans_in(options, *lifted_input(options, options).open()); });
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
