#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibrate/calibration_page.h"
#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "hqslam/pipeline/beam_check.h"
#include "hqslam/pipeline/pipeline.h"
#include "pages/open_page.h"
#include "pages/page.h"
#include "pages/text_table.h"
#include "product.h"
#include "recording/reading.h"
#include "recording/recording_choice.h"
#include "terminal/command_options.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

struct CalibrateOptions : InputChoice {
  int rows = 0;                                  ///< of the recording; 0: all
  double path_m = pipeline::kCalibrationPath_m;  ///< of whose scans the beams are estimated
  std::string out;
  bool open = false;
};

constexpr double kLeastPath_m = 20.0;

/// Follows the sensor until it has come as far as asked for, or tracking is lost.
pipeline::BeamCheck follow(const CalibrateOptions& options, ScanSource& source,
                           pipeline::Pipeline& pipeline, Reading& reading) {
  print_warnings(source, options.input);
  reading.wanted = wanted_scans(options);
  pipeline::BeamCheck beams(options.path_m);
  const InterruptGuard interrupt;
  Progress progress("calibrate", source.size());
  read_scans(source, interrupt, reading, [&](const ReadScan& read) {
    beams.add(read.scan.cloud, pipeline.process(read.scan).report, pipeline);
    progress.update(read.index + 1);
    return !beams.is_complete();
  });
  progress.finish();
  return beams;
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

/// Corrections that are too large for the sensor, or not significant.
void warn_of_doubtful(const slam::BeamCalibration& found, const SensorModel& corrected,
                      const std::string& input) {
  if (const std::string complaint = pipeline::complaint_about(corrected); !complaint.empty()) {
    to_stderr("hqslam: {}: {}\n", input, complaint);
  }
  if (!pipeline::has_errors(found)) {
    to_stderr(
        "hqslam: {}: the corrections are not significant (surfaces hardly become thinner, or far "
        "less than points are displaced): use the sensor as it is, not the file with these\n",
        input);
  }
}

void declare(CLI::App& app, CalibrateOptions& options) {
  Command command = add_command(
      app, "calibrate", "Determine corrections of a sensor's beams from a recording of a drive",
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
  Reading reading;
  const pipeline::BeamCheck beams = follow(options, input.recording, pipeline, reading);
  const std::vector<slam::LocatedScan> scans = beams.scans(pipeline.trajectory());
  if (beams.is_lost()) {
    to_stderr("hqslam: {}: tracking was lost after {:.1f} m; only the scans before are used\n",
              options.input, beams.path_m());
  }
  if (!(beams.path_m() >= kLeastPath_m)) {
    if (reading.end == ReadingEnd::kInterrupted) {
      return exit_status_of(reading, std::ssize(scans), std::nullopt);
    }
    throw Error(
        "{}: expected at least {} m of path, found {:.1f} m; give a recording in which the sensor "
        "is driven about, in clear air",
        options.input, kLeastPath_m, beams.path_m());
  }
  const slam::BeamCalibration found = slam::calibrate_beams(pipeline.sensor(), scans);
  const pipeline::Upsampler& rows_used = pipeline.upsampler();
  const SensorModel sensor =
      pipeline::corrected(rows_used.recorded(), rows_used.selected_rows(), found);
  warn_of_doubtful(found, sensor, options.input);
  validate(sensor);  // no other command would take corrections that are too large
  write_sensor_json(sensor, options.out);
  const CalibrationReport report{options.input, pipeline.sensor(), beams.path_m(),
                                 std::ssize(scans), found};
  write_text_file(calibration_html(report), page);
  to_stdout("{}\n{}", printed_table(beam_table(report)), calibration_summary(report));
  to_stdout("results: {}, {}\n", options.out, page);
  if (options.open) open_page(page);
  return exit_status_of(reading, std::ssize(scans), std::nullopt);
}

}  // namespace

void add_calibrate(CLI::App& app, Chosen& chosen) { add_subcommand<CalibrateOptions>(app, chosen); }

}  // namespace hqslam::tools
