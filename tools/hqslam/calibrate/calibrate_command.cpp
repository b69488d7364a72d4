#include "calibrate/calibrate_command.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "calibrate/calibration_page.h"
#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "hqslam/pipeline/pipeline.h"
#include "hqslam/slam/beam_calibration.h"
#include "pages/open_page.h"
#include "pages/page.h"
#include "recording/reading.h"
#include "terminal/command_options.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

/// Scans this far apart see enough of each other's surfaces and enough that is new.
constexpr double kStep_m = 1.0;
constexpr double kLeastPath_m = 20.0;

/// Between the poses before and after.
Twist velocity_at(const Trajectory& trajectory, std::size_t pose) {
  const StampedPose& before = trajectory[pose == 0 ? 0 : pose - 1];
  const StampedPose& after = trajectory[std::min(pose + 1, trajectory.size() - 1)];
  const double duration_s = after.stamp_s - before.stamp_s;
  if (!(duration_s > 0.0)) return {};
  return (1.0 / duration_s) * logarithm(before.T_map_sensor.inverse() * after.T_map_sensor);
}

/// The scans that the beams are calibrated from.
struct FollowedDrive : Reading {
  std::vector<slam::LocatedScan> scans;  ///< one per metre of path
  double path_m = 0.0;
  bool is_lost = false;
};
/// Follows the sensor until it has come as far as asked for, or tracking is lost.
FollowedDrive follow(const CalibrateOptions& options, ScanSource& source,
                     pipeline::Pipeline& pipeline) {
  print_warnings(source, options.input);
  FollowedDrive drive;
  drive.wanted = wanted_scans(options);
  std::vector<std::size_t> pose_of_scan;
  std::optional<Eigen::Vector3d> last_kept_m;
  std::optional<Eigen::Vector3d> last_m;
  const InterruptGuard interrupt;
  Progress progress("calibrate", source.size());
  read_scans(source, interrupt, drive, [&](const ReadScan& read) {
    pipeline::LocatedScan located = pipeline.process(read.scan);
    drive.is_lost = pipeline.segment_of_scan().back() > 0;
    if (drive.is_lost) return false;
    if (!is_registered(located.report.mapping_status)) return true;
    const Eigen::Vector3d position_m = located.report.T_map_sensor.translation();
    if (last_m) drive.path_m += (position_m - *last_m).norm();
    last_m = position_m;
    if (!last_kept_m || (position_m - *last_kept_m).norm() >= kStep_m) {
      drive.scans.emplace_back().cloud = std::move(located.cloud);
      pose_of_scan.push_back(pipeline.trajectory().size() - 1);
      last_kept_m = position_m;
    }
    progress.update(read.index + 1);
    return drive.path_m < options.path_m;
  });
  progress.finish();
  const Trajectory& trajectory = pipeline.trajectory();
  for (std::size_t i = 0; i < pose_of_scan.size(); ++i) {
    drive.scans[i].T_map_sensor = trajectory[pose_of_scan[i]].T_map_sensor;
    drive.scans[i].velocity = velocity_at(trajectory, pose_of_scan[i]);
  }
  return drive;
}

/// The sensor with corrections for all its rows, added to those that it has: a row that was not
/// used gets the nearest one's.
SensorModel corrected(SensorModel sensor, const std::optional<RowSelection>& rows,
                      const slam::BeamCalibration& found) {
  const auto count = static_cast<std::size_t>(sensor.rows());
  sensor.elevation_correction_rad.resize(count, 0.0);
  sensor.range_correction_m.resize(count, 0.0);
  const RowSelection used = rows.value_or(RowSelection{});
  for (int row = 0; row < sensor.rows(); ++row) {
    const auto beam = std::lround(static_cast<double>(row - used.offset) / used.stride);
    const slam::BeamCorrection& correction = found.beams[static_cast<std::size_t>(
        std::clamp(beam, 0L, static_cast<long>(found.beams.size()) - 1))];
    sensor.elevation_correction_rad[static_cast<std::size_t>(row)] += correction.elevation_rad;
    sensor.range_correction_m[static_cast<std::size_t>(row)] += correction.range_m;
  }
  return sensor;
}

std::string page_path(const std::string& out) {
  return std::filesystem::path(out).replace_extension(".html").string();
}

/// A sensor file that this command wrote, or a page.
bool is_calibrated_sensor(const std::string& path) {
  constexpr std::uintmax_t kMostBytes = 16U << 20U;
  std::error_code error;
  if (!(std::filesystem::file_size(path, error) <= kMostBytes)) return false;
  try {
    return !read_sensor_json(path).elevation_correction_rad.empty();
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

void declare(CLI::App& app, CalibrateOptions& options) {
  Command command = add_command(
      app, "calibrate", "Corrections of each beam of a sensor, from a recording of a drive",
      "Surfaces that several beams measure from several places determine the error of\n"
      "each beam's elevation and range. Beams that meet no ground, and errors that all\n"
      "beams share, are not corrected: the page shows how well each is known.");
  declare_input(command, options);
  declare_scans(command, options);
  command
      .option("--rows", &options.rows,
              "Use only this many rows of the recording, evenly spread (default: all)",
              {.within = std::pair(1, 1024)})
      .option("--path", &options.path_m,
              "Path from the beginning of the recording that is used, metres",
              {.shows_default = true, .within = std::pair(kLeastPath_m, 1000.0)})
      .option("--out", &options.out,
              "Sensor file (.json) to write, for --sensor of every other command; a page with the "
              "same name and .html shows what was found",
              {.required = true});
  declare_open(command, options.open);
}

int run(const CalibrateOptions& options) {
  if (!options.out.ends_with(".json")) {
    throw Error("--out {}: expected a file that ends in .json; name it so", options.out);
  }
  const std::string page = page_path(options.out);
  guard_output_file(options.out, {options.input, options.sensor}, is_calibrated_sensor);
  guard_output_file(page, {options.input}, page_marker("hqslam calibrate"));
  UpsamplingChoice rows;
  rows.rows = options.rows;
  pipeline::UpsampledRecording input = upsampled_recording(options, rows);
  if (input.upsampler.recorded().measured_rows) {
    throw Error(
        "{}: expected a recording of measured rows, found computed ones; give the recording that "
        "was upsampled",
        options.input);
  }
  pipeline::PipelineOptions without_loops;
  without_loops.slam_options.loop_closing.enabled = false;
  pipeline::Pipeline pipeline(std::move(input.upsampler), without_loops);
  FollowedDrive drive = follow(options, input.recording, pipeline);
  if (drive.is_lost) {
    to_stderr("hqslam: {}: tracking was lost after {:.1f} m; only the scans before are used\n",
              options.input, drive.path_m);
  }
  if (!(drive.path_m >= kLeastPath_m)) {
    if (drive.end == ReadingEnd::kInterrupted) {
      return exit_status_of(drive, std::ssize(drive.scans), std::nullopt);
    }
    throw Error(
        "{}: expected at least {} m of path, found {:.1f} m; give a recording in which the sensor "
        "is driven about",
        options.input, kLeastPath_m, drive.path_m);
  }
  const slam::BeamCalibration found = slam::calibrate_beams(pipeline.sensor(), drive.scans);
  const pipeline::Upsampler& rows_used = pipeline.upsampler();
  const SensorModel sensor = corrected(rows_used.recorded(), rows_used.selected_rows(), found);
  validate(sensor);  // no other command would take corrections that are too large
  write_sensor_json(sensor, options.out);
  const CalibrationReport report{options.input, pipeline.sensor(), drive.path_m,
                                 std::ssize(drive.scans), found};
  write_text_file(calibration_html(report), page);
  to_stdout("{}\n{}", aligned_text(beam_table(report)), calibration_summary(report));
  to_stdout("results: {}, {}\n", options.out, page);
  if (options.open) open_page(page);
  return exit_status_of(drive, std::ssize(drive.scans), std::nullopt);
}

}  // namespace hqslam::tools
