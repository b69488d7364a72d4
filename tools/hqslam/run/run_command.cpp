#include "run/run_command.h"

#include <fmt/format.h>

#include <iterator>
#include <utility>

#include "hqslam/core/error.h"
#include "pages/open_page.h"
#include "recording/recording_choice.h"
#include "run/run_output.h"
#include "run/run_passes.h"
#include "run/run_summary.h"
#include "terminal/command_options.h"
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
    if (!run.comparison->units.empty()) {
      to_stderr("hqslam: {}: {}\n", run.comparison->reference_path, run.comparison->units);
    }
  }
  to_stdout("{}", results_lines(run, options.out));
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

/// The exit status, with the lines on stderr that explain it.
int exit_status_of(const SlamRun& run, const RunOptions& options) {
  const int status = exit_status_of_maps(options, run);
  if (run.end == ReadingEnd::kComplete && status != kOk) return status;
  return exit_status_of(run, std::ssize(run.scans), run.scans_in_recording);
}

/// Compares the poses of which something is known in one frame: where a place was not recognized,
/// the pose is that of an earlier scan, and the poses of other submaps relative to it are unknown.
std::optional<ReferenceComparison> comparison_of(const SlamRun& run,
                                                 const TrajectoryFile& reference) {
  const Trajectory& all = run.trajectory;
  Trajectory known;
  std::vector<std::size_t> scan_of_known;
  for (std::size_t scan = 0; scan < all.size(); ++scan) {
    if (run.scans[scan].report.mapping_status == slam::Status::kNotRecognized) continue;
    if (run.submap_of_scan[scan] != run.largest_submap) continue;
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

void check_idle_options(const RunOptions& options) {
  if (options.slam.kind == "lego-loam" && !options.imu.empty() &&
      options.imu != recordings::kNoInertialData) {
    throw Error("--slam lego-loam: uses no inertial data; leave --imu out");
  }
}

/// Files that are read; the recording too, where it is one.
Paths inputs_of(const RunOptions& options) {
  return {options.input,    options.sensor,    options.stamps,  options.imu,
          options.upsample, options.reference, options.map_file};
}

}  // namespace

void declare(CLI::App& app, RunOptions& options) {
  Command command = add_command(
      app, "run", "Make a trajectory and a map from a recorded drive",
      "Writes into --out, in the level frame of the first scan (mounting in hqslam\n"
      "slam-options), or in that of --map:\n"
      "  trajectory.tum    stamp x y z qx qy qz qw per scan\n"
      "  trajectory.kitti  3x4 matrix per scan, row-major\n"
      "  covariances.csv   per scan the status of mapping, the submap, and the 6x6\n"
      "                    covariance of x y z and of the rotations about them\n"
      "  map.pcd           the features of all keyframes, with intensities where the\n"
      "                    recording has them\n"
      "  saved_map.npz     with --save-map: map and places for later drives\n"
      "  timings.json      time per stage and status of every scan\n"
      "  corrected_sensor.json  the sensor with corrected beams, for --sensor, where\n"
      "                    the run found errors of the beams (hqslam calibrate)\n"
      "  report.html       map, path, scans, error and times on one page\n"
      "and with --dense-map:\n"
      "  dense_map.pcd, dense_map.ply   x y z, intensity where the recording has it,\n"
      "                                 confidence, times_seen per voxel, binary\n"
      "and with --occupancy-grid, with cells along the frame's x and y:\n"
      "  map.pgm, map.yaml              where a robot can drive, for Nav2\n"
      "The first scan replaces the results of an earlier run in --out. Ctrl-C stops the\n"
      "run; the results up to then are valid. The status of mapping is ok, degenerate (a\n"
      "direction of motion is not determined), too few features, not converged, after a\n"
      "gap, or, with --map, map in doubt (scans fit it far less than its own drive's\n"
      "did) or not recognized, with the last known pose.");
  declare_input(command, options);
  declare_scans(command, options);
  declare_imu(command, options);
  declare_upsampling(command, options);
  command
      .option("--out", &options.out, "Folder for the results; made if it does not exist",
              {.required = true})
      .option("--reference", &options.reference,
              "Trajectory to compare with (TUM, or KITTI with one pose per scan); default: the "
              "truth of a simulated drive",
              {.given = Given::kFile});
  declare_open(command, options.open);
  declare_threads(command, options.threads);
  declare_slam_kind(command, options.slam);
  declare_slam_settings(command, options.slam);
  command.option("--no-calibration", &options.no_calibration,
                 "Do not correct the sensor's beams (default: a run whose first 150 m of path "
                 "determine that beams have errors begins anew with corrected ones)");
  declare_maps(command, options);
}

SlamRun run_and_write(RunOptions options, const InterruptGuard& interrupt) {
  use_threads(options.threads);
  refuse_to_write_into_recording(options.input, options.out);
  pipeline::UpsampledRecording input = upsampled_recording(options, options);
  print_warnings(input.recording, options.input);
  const std::optional<TrajectoryFile> reference = reference_of(options, input.recording);
  RunOutput output(options.out, inputs_of(options));

  SlamRun run = slam_over(options, output, interrupt, std::move(input));
  if (run.scans.empty()) return run;  // interrupted at once: an earlier run's results stay
  if (reference) {
    run.comparison = comparison_of(run, *reference);
    if (!run.comparison) to_stderr("hqslam: {}\n", no_pairs_message(run, *reference));
  }
  output.write_results(run);
  add_maps(options, options, options, interrupt, output, run);
  return run;
}

int run(const RunOptions& options) {
  check_idle_options(options);
  const InterruptGuard interrupt;
  const SlamRun run = run_and_write(options, interrupt);
  if (!run.scans.empty()) print_summary(run, options);
  if (!run.scans.empty() && options.open) open_page(options.out + "/report.html");
  return exit_status_of(run, options);
}

}  // namespace hqslam::tools
