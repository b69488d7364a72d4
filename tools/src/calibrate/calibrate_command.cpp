#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "files/result_files.h"
#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "hqslam/slam/beam_calibration.h"
#include "hqslam/slam/slam.h"
#include "lift/lifted_input.h"
#include "recording/reading.h"
#include "report/chart.h"
#include "report/page.h"
#include "terminal/command_options.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

using slam::BeamCorrection;

/// In the head of a page of hqslam calibrate.
constexpr const char* kPageMarker = "<meta name=\"generator\" content=\"hqslam calibrate\">";

constexpr double kMillimetres = 1000.0;

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
FollowedDrive follow(LiftedInput& input, double wanted_m) {
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

/// What hqslam calibrate found, and from what.
struct CalibrationReport {
  std::string recording;
  SensorModel sensor;
  double path_m = 0.0;
  std::int64_t scans = 0;
  slam::BeamCalibration found;
};

std::vector<double> of_beams(const CalibrationReport& report,
                             const std::function<double(const BeamCorrection&)>& value) {
  // Rows fall, and a chart's x rises.
  std::vector<double> values;
  for (auto beam = report.found.beams.rbegin(); beam != report.found.beams.rend(); ++beam) {
    values.push_back(value(*beam));
  }
  return values;
}

std::string chart_of(const CalibrationReport& report, const char* y_label,
                     std::vector<Series> series) {
  Chart chart;
  chart.x_label = "elevation of the beam, degrees";
  chart.y_label = y_label;
  for (int row = report.sensor.rows() - 1; row >= 0; --row) {
    chart.x.push_back(report.sensor.beam_elevation_rad[row] * kDegreesPerRadian);
  }
  chart.series = std::move(series);
  return chart_html(chart);
}

/// A value between two lines, one standard deviation to either side.
std::vector<Series> with_sigma(const CalibrationReport& report, const char* name, double scale,
                               double BeamCorrection::*value, double BeamCorrection::*sigma) {
  return {{name, "mapping", of_beams(report, [&](const auto& b) { return scale * b.*value; })},
          {"one standard deviation more", "reading",
           of_beams(report, [&](const auto& b) { return scale * (b.*value + b.*sigma); })},
          {"one less", "reading",
           of_beams(report, [&](const auto& b) { return scale * (b.*value - b.*sigma); })}};
}

/// Before and after the corrections.
std::string distances_chart(const CalibrationReport& report, const char* y_label,
                            double slam::BeamDistance::*distance) {
  const auto of = [&](slam::BeamDistance BeamCorrection::*when) {
    return of_beams(report, [=](const auto& b) { return kMillimetres * (b.*when).*distance; });
  };
  return chart_of(report, y_label,
                  {{"as measured", "upsampling", of(&BeamCorrection::before)},
                   {"corrected", "features", of(&BeamCorrection::after)}});
}

/// A row per beam, with standard deviations.
TextTable beam_table(const CalibrationReport& report) {
  TextTable table{.columns = {"beam", "elevation deg", "correction deg", "+-", "range mm", "+-",
                              "off ground mm", "after", "off walls mm", "after"}};
  for (std::size_t row = 0; row < report.found.beams.size(); ++row) {
    const BeamCorrection& beam = report.found.beams[row];
    const auto millimetres = [](double value_m) {
      return fmt::format("{:.1f}", kMillimetres * value_m);
    };
    const auto degrees = [](double value_rad) {
      return fmt::format("{:.3f}", kDegreesPerRadian * value_rad);
    };
    table.rows.push_back(
        {std::to_string(row),
         fmt::format("{:.2f}", kDegreesPerRadian * report.sensor.beam_elevation_rad[row]),
         degrees(beam.elevation_rad), degrees(beam.elevation_sigma_rad), millimetres(beam.range_m),
         millimetres(beam.range_sigma_m), millimetres(beam.before.ground_m),
         millimetres(beam.after.ground_m), millimetres(beam.before.walls_m),
         millimetres(beam.after.walls_m)});
  }
  return table;
}

/// One line.
std::string calibration_summary(const CalibrationReport& report) {
  return fmt::format(
      "{} scans along {:.0f} m; points lie {:.1f} mm off their surfaces, {:.1f} mm after it\n",
      report.scans, report.path_m, kMillimetres * report.found.residual_before_m,
      kMillimetres * report.found.residual_after_m);
}

/// The page: rings against their surfaces, before and after.
std::string calibration_html(const CalibrationReport& report) {
  Page page("Calibration of " + report.recording);
  page.head_html(kPageMarker);
  page.heading(1, "Where the beams really look");
  page.paragraph(fmt::format("{}, {} of {} beams. {}", report.recording, report.sensor.name,
                             report.sensor.rows(), calibration_summary(report)));
  page.heading(2, "Rings against the ground");
  page.paragraph(
      "How far each beam's points lie above the ground that all beams see, in the mean.");
  page.html(distances_chart(report, "above the ground, mm", &slam::BeamDistance::ground_m));
  page.heading(2, "Rings against walls");
  page.paragraph("How far they lie this side of upright surfaces.");
  page.html(distances_chart(report, "this side of walls, mm", &slam::BeamDistance::walls_m));
  page.heading(2, "Corrections");
  page.paragraph(
      "What is added to each beam's elevation and range. A beam that meets no ground says nothing "
      "about its elevation, and no drive tells errors apart that bend the whole world like a bowl: "
      "there the correction stays near zero.");
  page.html(
      chart_of(report, "elevation, degrees",
               with_sigma(report, "added to the elevation", kDegreesPerRadian,
                          &BeamCorrection::elevation_rad, &BeamCorrection::elevation_sigma_rad)));
  page.html(chart_of(report, "range, mm",
                     with_sigma(report, "added to the range", kMillimetres,
                                &BeamCorrection::range_m, &BeamCorrection::range_sigma_m)));
  page.table(beam_table(report));
  return page.text();
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

void declare_calibrate(CLI::App& app, CalibrateOptions& options) {
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

int calibrate_command(const CalibrateOptions& options) {
  if (!options.out.ends_with(".json")) {
    throw Error("--out {}: expected a file that ends in .json; name it so", options.out);
  }
  const std::string page = page_path(options.out);
  guard_output_file(options.out, {options.input, options.sensor}, is_calibrated_sensor);
  guard_output_file(page, {options.input}, kPageMarker);
  LiftingChoice rows;
  rows.rows = options.rows;
  LiftedInput input = lifted_input(options, rows);
  if (input.recorded.measured_rows) {
    throw Error(
        "{}: computed rows tell nothing of beams, expected a recording of measured ones; give the "
        "one that was lifted",
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
