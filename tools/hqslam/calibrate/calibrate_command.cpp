#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "calibrate/calibration_page.h"
#include "commands.h"
#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "hqslam/slam/beam_calibration.h"
#include "hqslam/slam/slam.h"
#include "pages/page.h"
#include "recording/reading.h"
#include "terminal/command_options.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"
#include "upsample/upsampled_input.h"

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

/// Follows the sensor until it has come as far as asked for, or the way is lost, and keeps what is
/// calibrated from.
struct FollowedDrive : Reading {
  std::vector<slam::LocatedScan> scans;  ///< of every metre of path
  double path_m = 0.0;
  bool is_lost = false;
};
FollowedDrive follow(UpsampledInput& input, double wanted_m) {
  slam::SlamOptions options;
  options.loop_closing.enabled = false;
  slam::Slam slam(input.seen(), options);
  const auto source = input.open();
  print_warnings(*source, input.recording.input);
  FollowedDrive drive;
  std::vector<std::size_t> pose_of_scan;
  std::optional<Eigen::Vector3d> last_kept_m;
  std::optional<Eigen::Vector3d> last_m;
  const InterruptGuard interrupt;
  Progress progress("calibrate", source->size());
  read_scans(*source, interrupt, drive, [&](const ReadScan& read) {
    const OrganizedCloud cloud = input.measured(read.scan.cloud);
    slam.add_imu(read.scan.imu);
    const slam::ScanReport report = slam.process(cloud, read.scan.stamp_s);
    drive.is_lost = slam.segment_of_scan().back() > 0;
    if (drive.is_lost) return false;
    if (!is_registered(report.mapping_status)) return true;
    const Eigen::Vector3d position_m = report.T_map_sensor.translation();
    if (last_m) drive.path_m += (position_m - *last_m).norm();
    last_m = position_m;
    if (!last_kept_m || (position_m - *last_kept_m).norm() >= kStep_m) {
      drive.scans.emplace_back().cloud = cloud;
      pose_of_scan.push_back(slam.trajectory().size() - 1);
      last_kept_m = position_m;
    }
    progress.update(read.index + 1);
    return drive.path_m < wanted_m;
  });
  progress.finish();
  for (std::size_t i = 0; i < pose_of_scan.size(); ++i) {
    drive.scans[i].T_map_sensor = slam.trajectory()[pose_of_scan[i]].T_map_sensor;
    drive.scans[i].velocity = velocity_at(slam.trajectory(), pose_of_scan[i]);
  }
  return drive;
}

/// The sensor with corrections for all its rows: those of a row that was not looked at are the
/// nearest one's. What the sensor's file said before counts too.
SensorModel corrected(SensorModel sensor, const std::optional<RowSelection>& rows,
                      const slam::BeamCalibration& found) {
  const auto count = static_cast<std::size_t>(sensor.rows());
  sensor.elevation_correction_rad.resize(count, 0.0);
  sensor.range_correction_m.resize(count, 0.0);
  const RowSelection looked_at = rows.value_or(RowSelection{});
  for (int row = 0; row < sensor.rows(); ++row) {
    const auto beam = std::lround(static_cast<double>(row - looked_at.offset) / looked_at.stride);
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
      app, "calibrate", "What each beam of a sensor is off by, from a recording of it driving",
      "Surfaces that several beams see from several places tell what each beam's elevation and\n"
      "range are off by. Beams that meet no ground, and errors that all beams share, stay as they\n"
      "are: the page says how well each is known.");
  declare_input(command, options);
  command.option("--rows", &options.rows,
                 "Look at so many rows of the recording, evenly spaced (default: all)",
                 {.within = std::pair(1, 1024)});
  command.option("--path", &options.path_m,
                 "Metres of path from the recording's beginning that are looked at",
                 {.shows_default = true, .within = std::pair(kLeastPath_m, 1000.0)});
  command.option("--out", &options.out,
                 "Sensor file to write, for --sensor of every other command; a page with the same "
                 "name and .html shows what was found",
                 {.required = true});
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
  UpsampledInput input = upsampled_input(options, rows);
  if (input.recorded.measured_rows) {
    throw Error(
        "{}: computed rows tell nothing of beams, expected a recording of measured ones; give the "
        "one that was upsampled",
        options.input);
  }
  FollowedDrive drive = follow(input, options.path_m);
  if (drive.is_lost) {
    to_stderr("hqslam: {}: the way was lost after {:.1f} m; only the scans before are looked at\n",
              options.input, drive.path_m);
  }
  if (!(drive.path_m >= kLeastPath_m)) {
    if (drive.end == ReadingEnd::kInterrupted) {
      return exit_status_of(drive, std::ssize(drive.scans), std::nullopt);
    }
    throw Error(
        "{}: the sensor moved by {:.1f} m, expected at least {} m; give a recording in which it is "
        "driven about",
        options.input, drive.path_m, kLeastPath_m);
  }
  const slam::BeamCalibration found = slam::calibrate_beams(input.seen(), drive.scans);
  const SensorModel sensor = corrected(input.recorded, input.rows, found);
  validate(sensor);  // what is too far off to be a calibration no other command would take
  write_sensor_json(sensor, options.out);
  const CalibrationReport report{options.input, input.seen(), drive.path_m, std::ssize(drive.scans),
                                 found};
  write_text_file(calibration_html(report), page);
  to_stdout("{}\n{}", aligned_text(beam_table(report)), calibration_summary(report));
  to_stdout("results: {}, {}\n", options.out, page);
  return exit_status_of(drive, std::ssize(drive.scans), std::nullopt);
}

}  // namespace hqslam::tools
