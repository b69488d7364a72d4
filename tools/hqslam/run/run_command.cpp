#include "run/run_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>

#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "recording/recording_choice.h"
#include "run/run_output.h"
#include "run/run_summary.h"
#include "run/slam_session.h"
#include "terminal/command_options.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

/// Where stamps are counted, that of a reference recorded with a clock is another time, and none of
/// its poses would be compared.
void require_stamps_of_scans(const TrajectoryFile& reference, std::int64_t scans,
                             double scan_period_s) {
  const double first_s = reference.poses.front().stamp_s;
  const double last_s = reference.poses.back().stamp_s;
  const double end_s = static_cast<double>(scans) * scan_period_s;
  if (first_s <= end_s && last_s >= 0.0) return;
  throw Error(
      "{}: has stamps from {:.3f} to {:.3f} s, expected some between 0 and {:.3f} s (the scans "
      "have none: theirs are counted in turns of {} s from 0 s); shift them, name the scans' with "
      "--stamps, or give one pose per scan in KITTI's form",
      reference.path, first_s, last_s, end_s, scan_period_s);
}

std::optional<TrajectoryFile> reference_of(const RunOptions& options, const ScanSource& source) {
  const std::string path =
      options.reference.empty() ? file_of_drive(options.input, "truth.tum") : options.reference;
  if (path.empty()) return std::nullopt;
  TrajectoryFile reference = read_trajectory_file(path);
  if (reference.has_stamps && source.has_stamps()) return reference;
  const std::int64_t scans = scans_in(options, source);
  if (reference.has_stamps) {
    require_stamps_of_scans(reference, scans, source.sensor().scan_period_s);
  } else if (std::ssize(reference.poses) != scans) {
    throw Error(
        "{}: has {} poses without stamps, but {} has {} scans; give one pose per scan or a TUM "
        "file",
        path, reference.poses.size(), options.input, scans);
  }
  return reference;
}

void print_summary(const SlamRun& run, const RunOptions& options) {
  to_stdout("{}", run_summary(run));
  if (run.comparison) {
    const AbsolutePoseError& error = run.comparison->error;
    to_stdout("APE RMSE {:.3f} m over {} poses against {} (alignment: {})\n",
              error.translation_statistics.rmse, error.translation_m.size(),
              run.comparison->reference_path, name(error.alignment));
  }
  for (const std::string& summary : {run.dense_map_summary, run.occupancy_grid_summary}) {
    if (!summary.empty()) to_stdout("{}\n", summary);
  }
  to_stdout("{}", results_line(run, options.out));
}

/// Why they were not compared.
std::string no_pairs_message(const SlamRun& run, const TrajectoryFile& reference) {
  const auto span = [](const Trajectory& of) {
    return fmt::format("{:.3f} to {:.3f} s", of.front().stamp_s, of.back().stamp_s);
  };
  return fmt::format(
      "{}: fewer than 3 of its poses{} are within 0.02 s of a located scan, of {}: not compared "
      "with it; give the stamps of trajectory.tum",
      reference.path, reference.has_stamps ? ", of " + span(reference.poses) + "," : "",
      span(run.trajectory));
}

/// What to tell the shell, with the lines on stderr that explain it.
int exit_status_of(const SlamRun& run, const RunOptions& options) {
  for (const std::string& failed : run.failed_maps) to_stderr("hqslam: {}\n", failed);
  if (run.end == ReadingEnd::kComplete && !run.failed_maps.empty()) return kWrongInput;
  const bool lacks_dense_map = options.dense_map && run.dense_map_summary.empty();
  const bool lacks_grid = options.occupancy_grid && run.occupancy_grid_summary.empty();
  if (run.end == ReadingEnd::kComplete && (lacks_dense_map || lacks_grid)) {
    to_stderr("hqslam: interrupted; the results are valid, but there is no {}\n",
              lacks_dense_map ? "dense map" : "occupancy grid");
    return kInterrupted;
  }
  return exit_status_of(run, std::ssize(run.scans), run.scans_in_recording);
}

/// Compares the poses of which something is known in one frame: where a place was not recognized,
/// the pose is that of an earlier scan, and how other parts of the map lie is not known.
std::optional<ReferenceComparison> comparison_of(const SlamRun& run,
                                                 const TrajectoryFile& reference) {
  const Trajectory& all = run.trajectory;
  Trajectory known;
  std::vector<std::size_t> scan_of_known;
  for (std::size_t scan = 0; scan < all.size(); ++scan) {
    if (run.scans[scan].report.mapping_status == slam::Status::kNotRecognized) continue;
    if (run.part_of_scan[scan] != run.map_part) continue;
    known.push_back(all[scan]);
    scan_of_known.push_back(scan);
  }
  const TrajectoryFile stamped{reference.path,
                               with_stamps_of_scans(reference, all, scan_of_pose(run)), true};
  if (known.size() == all.size()) return compare_with_reference(all, stamped);
  std::optional<ReferenceComparison> comparison = compare_with_reference(known, stamped);
  if (!comparison) return std::nullopt;
  AbsolutePoseError& error = comparison->error;
  for (std::size_t& pose : error.pairs.estimate) pose = scan_of_known[pose];
  const Pose T_reference_map =
      error.aligned_estimate.front().T_map_sensor * known.front().T_map_sensor.inverse();
  error.aligned_estimate = all;
  for (StampedPose& pose : error.aligned_estimate) {
    pose.T_map_sensor = T_reference_map * pose.T_map_sensor;
  }
  return comparison;
}

/// x, y and yaw are the user's, the rest is that of the nearest place of the map: streets have
/// slopes.
Pose start_on_path(const std::vector<slam::SavedPlace>& places, const std::vector<double>& start) {
  if (!std::ranges::all_of(start, [](double v) { return std::isfinite(v); })) {
    throw Error("--start {}: expected three numbers; give X,Y,YAW", fmt::join(start, ","));
  }
  const Eigen::Vector2d start_m(start[0], start[1]);
  const auto distance_m = [&](const slam::SavedPlace& place) {
    return (place.T_map_sensor.translation().head<2>() - start_m).norm();
  };
  const auto nearest = std::ranges::min_element(places, {}, distance_m);
  const Eigen::Vector3d rpy_rad = roll_pitch_yaw_rad(nearest->T_map_sensor);
  return pose_from_xyz_rpy({start[0], start[1], nearest->T_map_sensor.translation().z()},
                           rpy_rad.x(), rpy_rad.y(), radians(start[2]));
}

/// What runs the scans of a recording: which SLAM, in which map.
pipeline::PipelineOptions pipeline_options(const RunOptions& options) {
  pipeline::PipelineOptions pipeline;
  pipeline.slam = slam_kind(options.slam);
  pipeline.slam_options = slam_options(options.slam);
  if (pipeline.slam == pipeline::SlamKind::kLegoLoam && options.save_map) {
    throw Error("--slam lego-loam: recognizes no places for a saved map; leave --save-map out");
  }
  if (options.map_file.empty()) return pipeline;
  pipeline.slam_options.loop_closing.enabled = false;
  pipeline.map = slam::read_saved_map(options.map_file);
  if (!options.start.empty() && !pipeline.map->places.empty()) {
    pipeline.T_map_level_start = start_on_path(pipeline.map->places, options.start);
  }
  return pipeline;
}

/// All other results are written by now: what goes wrong here costs the dense map alone.
void add_dense_map(const RunOptions& options, const InterruptGuard& interrupt, RunOutput& output,
                   SlamRun& run) {
  DenseMapRun dense_map = build_dense_map(options, options, poses_of(run), options.map, interrupt);
  if (interrupt.stop_requested()) return;
  run.dense_map_summary = dense_map_summary(dense_map);
  output.write_dense_map(run, dense_map);
}

/// What goes wrong here costs the occupancy grid alone.
void add_occupancy_grid(const RunOptions& options, const InterruptGuard& interrupt,
                        RunOutput& output, SlamRun& run) {
  const OccupancyGridRun grid =
      build_occupancy_grid(options, options, poses_of(run), options.grid, interrupt);
  if (interrupt.stop_requested()) return;
  run.occupancy_grid_summary = grid.summary;
  output.write_occupancy_grid(run, grid.map);
}

/// SLAM over the recording, with intermediate results now and then.
void process_all(ScanSource& source, SlamSession& session, RunOutput& output,
                 const InterruptGuard& interrupt) {
  SlamRun& run = session.run();
  run.scans_in_recording = source.size();
  Progress progress(fmt::format("slam {}x{}", run.rows, run.columns), source.size());
  read_scans(source, interrupt, run, [&](const ReadScan& read) {
    session.process(read.scan, read.index, read.reading_s);
    if (output.checkpoint_due()) output.write_checkpoint(session.run_so_far());
    progress.update(std::ssize(run.scans), source.read_share());
    return true;
  });
  progress.update(std::ssize(run.scans), source.read_share());
  progress.finish();
  if (run.end == ReadingEnd::kComplete) {
    run.scans_in_recording = std::ssize(run.scans) + run.left_out.scans;
  }
}

/// Files that are read; the recording too, where it is one.
Paths inputs_of(const RunOptions& options) {
  return {options.input,    options.sensor,    options.stamps,   options.imu,
          options.upsample, options.reference, options.map_file, options.slam.file};
}

}  // namespace

void declare(CLI::App& app, RunOptions& options) {
  Command command = add_command(
      app, "run", "From a recorded drive to a trajectory and a map",
      "Writes into --out, in the frame of the first scan turned level (see mounting\n"
      "in hqslam slam-options), or in that of --map:\n"
      "  trajectory.tum    stamp x y z qx qy qz qw per scan\n"
      "  trajectory.kitti  3x4 matrix per scan, row-major\n"
      "  covariances.csv   per scan the status of mapping, the submap, and the 6x6\n"
      "                    covariance of x y z and of the rotations about them\n"
      "  map.pcd           the features of all keyframes, with intensities where the\n"
      "                    recording has them\n"
      "  saved_map.npz     with --save-map: map and places for later drives\n"
      "  timings.json      time per stage and status of every scan\n"
      "  report.html       map, path, scans, error and times on one page\n"
      "and with --dense-map:\n"
      "  dense_map.pcd, dense_map.ply   x y z, intensity where the recording has it,\n"
      "                                 confidence, times_seen per voxel, binary\n"
      "and with --occupancy-grid, with cells along the frame's x and y:\n"
      "  map.pgm, map.yaml              where a robot can drive, for Nav2\n"
      "The results of an earlier run in --out are replaced from the first scan on.\n"
      "Ctrl-C stops the run; what is written up to then is valid. The status of\n"
      "mapping is ok, degenerate (some direction of motion is not determined), too few\n"
      "features, not converged, after a gap, or, with --map, not recognized: the pose\n"
      "is then the last known one.");
  declare_input(command, options);
  declare_imu(command, options);
  declare_upsampling(command, options);
  command
      .option("--out", &options.out, "Folder for the results; made if it does not exist",
              {.required = true})
      .option("--reference", &options.reference,
              "Trajectory to compare with (TUM, or KITTI with one pose per scan); default: the "
              "truth of a simulated drive",
              {.given = Given::kFile});
  declare_threads(command, options.threads);
  declare_slam_kind(command, options.slam);
  declare_slam_settings(command, options.slam);
  command
      .option("--save-map", &options.save_map,
              "Also write saved_map.npz, in which later drives can be located",
              {.excludes = {"--no-loop-closing"}})
      .option("--map", &options.map_file,
              "Locate the drive in this saved_map.npz of an earlier drive instead of making a map; "
              "the file stays as it is",
              {.given = Given::kFile, .excludes = {"--save-map"}})
      .option("--start", &options.start,
              "X,Y,YAW: the first pose in the map of --map, in metres and degrees, within 10 m and "
              "25 degrees; default: it is searched in all of the map",
              {.delimiter = ',', .values = 3, .needs = {"--map"}})
      .option("--dense-map", &options.dense_map,
              "Also make a dense map of the points of all scans, measured and upsampled; reads the "
              "recording twice more");
  declare_dense_map(command, options.map, {"--dense-map"});
  declare_occupancy_grid(command, options.occupancy_grid, options.grid);
}

SlamRun run_and_write(const RunOptions& options, const InterruptGuard& interrupt) {
  use_threads(options.threads);
  refuse_to_write_into_recording(options.input, options.out);
  options_of(options.grid);  // refused before the drive, not after it
  pipeline::UpsampledRecording input = upsampled_recording(options, options);
  ScanSource& source = input.recording;
  const std::size_t printed = print_warnings(source, options.input);
  const std::optional<TrajectoryFile> reference = reference_of(options, source);
  RunOutput output(options.out, inputs_of(options));

  SlamSession session(std::move(input.upsampler), pipeline_options(options), options.input);
  session.run().located_in = options.map_file;
  process_all(source, session, output, interrupt);
  print_later_warnings(source, printed);
  SlamRun run = session.finished(options.save_map);
  if (run.scans.empty()) return run;  // interrupted at once: an earlier run's results stay
  if (reference) {
    run.comparison = comparison_of(run, *reference);
    if (!run.comparison) to_stderr("hqslam: {}\n", no_pairs_message(run, *reference));
  }
  output.write_results(run);
  const auto add = [&](bool wanted, const auto& make) {
    if (!wanted || interrupt.stop_requested()) return;
    try {
      make();
    } catch (const Error& error) {
      run.failed_maps.emplace_back(error.what());
    }
  };
  // The grid, which is small, comes first: the report with the dense map has both.
  add(options.occupancy_grid, [&] { add_occupancy_grid(options, interrupt, output, run); });
  add(options.dense_map, [&] { add_dense_map(options, interrupt, output, run); });
  return run;
}

int run(const RunOptions& options) {
  const InterruptGuard interrupt;
  const SlamRun run = run_and_write(options, interrupt);
  if (!run.scans.empty()) print_summary(run, options);
  return exit_status_of(run, options);
}

}  // namespace hqslam::tools
