#include "run_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <omp.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <cstdio>
#include <memory>

#include "exit_status.h"
#include "hqslam/core/error.h"
#include "hqslam/recordings/recording.h"
#include "recording_sensor.h"
#include "run_output.h"
#include "timing_statistics.h"
#include "upsampling_plan.h"

namespace hqslam::tools {
namespace {

/// What is read and what SLAM gets to see of it.
struct RunPlan {
  std::string input;
  SensorModel recording_sensor;
  std::optional<RowSelection> rows;
  std::optional<nn::Upsampler> upsampler;

  SlamRunSpec spec() { return {input, rows, upsampler ? &*upsampler : nullptr}; }
};

RunPlan plan_of(const RunOptions& options) {
  if (!options.upsample.empty()) {
    UpsamplingPlan plan = plan_upsampling({options.input, options.sensor, options.upsample,
                                           options.rows, options.least_confidence, options.stream});
    return {options.input, plan.recording_sensor, plan.rows, std::move(plan.upsampler)};
  }
  RunPlan plan;
  plan.input = options.input;
  plan.recording_sensor = required_recording_sensor(options.input, options.sensor, options.stream);
  if (options.rows > 0 && options.rows != plan.recording_sensor.rows()) {
    plan.rows = selection_for(plan.recording_sensor.rows(), options.rows);
  }
  return plan;
}

/// A scan's stamp is its index times the sensor's period: that of a reference recorded with a clock
/// is another time, and none of its poses would be compared.
void require_stamps_of_scans(const TrajectoryFile& reference, std::int64_t scans,
                             double scan_period_s) {
  const double first_s = reference.poses.front().stamp_s;
  const double last_s = reference.poses.back().stamp_s;
  const double end_s = static_cast<double>(scans) * scan_period_s;
  if (first_s <= end_s && last_s >= 0.0) return;
  throw Error(fmt::format(
      "{}: has stamps from {:.3f} to {:.3f} s, expected some between 0 and {:.3f} s (the "
      "stamp of scan i is i times {} s); shift them, or give one pose per scan in "
      "KITTI's form",
      reference.path, first_s, last_s, end_s, scan_period_s));
}

std::optional<TrajectoryFile> reference_of(const RunOptions& options, const ScanSource& source) {
  const std::int64_t scans = source.size();
  const std::string path =
      options.reference.empty() ? file_of_drive(options.input, "truth.tum") : options.reference;
  if (path.empty()) {
    return std::nullopt;
  }
  TrajectoryFile reference = read_trajectory_file(path);
  if (!reference.has_stamps && static_cast<std::int64_t>(reference.poses.size()) != scans) {
    throw Error(
        fmt::format("{}: has {} poses without stamps, but {} has {} scans; give one pose per scan "
                    "or a TUM file",
                    path, reference.poses.size(), options.input, scans));
  }
  // A simulated drive's scans have the stamps of its truth.
  // Those of a capture or a bag have the recording's own.
  if (reference.has_stamps && file_of_drive(options.input, "truth.tum").empty() &&
      !recordings::is_capture_or_bag(options.input)) {
    require_stamps_of_scans(reference, scans, source.sensor().scan_period_s);
  }
  return reference;
}

RecordingOptions recording_options(const RunOptions& options) {
  RecordingOptions recording;
  recording.row_order =
      options.row_order == "lowest-first" ? RowOrder::kLowestFirst : RowOrder::kHighestFirst;
  recording.capture_time =
      options.motion_corrected ? CaptureTime::kMotionCorrected : CaptureTime::kRolling;
  recording.times_from_azimuth = options.capture == "rolling";
  recording.stamps = options.stamps;
  return recording;
}

InputRecording input_recording(const RunOptions& options) {
  return {options.input, options.sensor, options.stream, options.kept_return == "last",
          recording_options(options)};
}

double median_upsampling_ms(const SlamRun& run) {
  std::vector<double> times_ms;
  for (const ScanRecord& scan : run.scans) {
    times_ms.push_back(1e3 * scan.upsampling_s);
  }
  return distribution_of(std::move(times_ms)).median;
}

/// "mapping: 198 scans ok, 2 degenerate; 1 loop closed"
std::string mapping_summary(const SlamRun& run) {
  std::vector<std::string> counts;
  for (const auto& [status, scans] : status_counts(run, &slam::ScanReport::mapping_status)) {
    if (scans > 0) {
      counts.push_back(
          fmt::format("{}{} {}", scans, counts.empty() ? " scans" : "", slam::name(status)));
    }
  }
  std::string summary = fmt::format("mapping: {}", fmt::join(counts, ", "));
  if (run.loop_closing) {
    const std::int64_t closed = loops_closed(run);
    summary += fmt::format("; {} loop{} closed", closed, closed == 1 ? "" : "s");
  }
  return summary;
}

void print_summary(const RunResult& result, const RunOptions& options) {
  const SlamRun& run = result.run;
  fmt::print("{} scans, {:.1f} m of path, {:.1f} scans/s\n", run.scans.size(),
             path_length_m(run.trajectory), scans_per_second(run));
  fmt::print("{}\n", mapping_summary(run));
  if (!run.upsampled_by.empty()) {
    fmt::print("upsampled to {} rows by {}: {:.1f} ms a scan (median)\n", run.rows,
               run.upsampled_by, median_upsampling_ms(run));
  }
  if (result.comparison) {
    const AbsolutePoseError& error = result.comparison->error;
    fmt::print("APE RMSE {:.3f} m over {} poses against {} (alignment: {})\n",
               error.translation_statistics.rmse, error.translation_m.size(),
               result.comparison->reference_path, name(error.alignment));
  }
  fmt::print("results: {}/trajectory.tum, trajectory.kitti, map.pcd, timings.json, report.html\n",
             options.out);
}

/// What to tell the shell, with the one line on stderr that explains it.
int exit_status_of(const SlamRun& run) {
  if (run.left_out.scans > 0 && !run.scans.empty()) {
    fmt::print(stderr, "hqslam: {}\n", run.left_out.text());
  }
  switch (run.end) {
    case RunEnd::kInterrupted:
      fmt::print(stderr,
                 "hqslam: interrupted after {} of {} scans; the results up to there are valid\n",
                 run.scans.size(), run.scans_in_recording);
      return kInterrupted;
    case RunEnd::kUnreadableScan:
      fmt::print(stderr,
                 "hqslam: {}; stopped after {} of {} scans, the results up to there are valid\n",
                 run.end_message, run.scans.size(), run.scans_in_recording);
      return kWrongInput;
    case RunEnd::kComplete:
      break;
  }
  return kOk;
}

}  // namespace

void declare_run(CLI::App& app, RunOptions& options) {
  CLI::App* command = app.add_subcommand("run", "From a recorded drive to a trajectory and a map");
  command
      ->add_option(
          "INPUT", options.input,
          "Capture (.pcap, .pcapng) or bag (.db3, .mcap, .bag) of a sensor, folder of KITTI "
          ".bin files, folder of .pcd files, .npy stack of range images (N x H x W, "
          "float32 metres), or folder written by hqslam simulate")
      ->required()
      ->check(CLI::ExistingPath);
  command->add_option("--sensor", options.sensor,
                      fmt::format("{}, or a .json file with the beam angles (Ouster's metadata "
                                  "files too); not needed where the recording says it",
                                  fmt::join(sensor_preset_names(), ", ")));
  command->add_option("--stream", options.stream,
                      "Which stream of a capture or a bag: a topic, or a port or sender:port");
  command
      ->add_option("--return", options.kept_return,
                   "Which one is kept where a sensor sends two returns of a pulse")
      ->check(CLI::IsMember({"strongest", "last"}))
      ->capture_default_str();
  command
      ->add_option("--rows", options.rows, "Use only this many of the sensor's rows, evenly spread")
      ->check(CLI::Range(1, 1000000000));
  command->add_option("--out", options.out, "Folder for the results; made if it is not there")
      ->required();
  command
      ->add_option("--reference", options.reference,
                   "Trajectory to compare with (TUM, or KITTI with one pose per scan); by default "
                   "the truth of a simulated drive")
      ->check(CLI::ExistingFile);
  command
      ->add_option("--row-order", options.row_order,
                   "Where row 0 of the images of a .npy stack looks")
      ->check(CLI::IsMember({"highest-first", "lowest-first"}))
      ->capture_default_str();
  command->add_flag("--motion-corrected", options.motion_corrected,
                    "The scans of a .npy stack are already corrected for the sensor's motion");
  command
      ->add_option(
          "--capture", options.capture,
          "How points without a time were captured: rolling, while the sensor turned (each "
          "has the time of its azimuth), or corrected for motion (default)")
      ->check(CLI::IsMember({"rolling", "corrected"}));
  command->add_option("--stamps", options.stamps,
                      "File with the stamp of each scan (seconds, or dates as KITTI's "
                      "timestamps.txt), or 'names' for the numbers in the files' names");
  command
      ->add_option("--upsample", options.upsample,
                   fmt::format("Fill the rows between the measured ones first: a trained network "
                               "(.npz), or interpolation ({})",
                               fmt::join(nn::interpolation_names(), ", ")))
      ->check(CLI::ExistingFile | CLI::IsMember(nn::interpolation_names()));
  command
      ->add_option("--confidence", options.least_confidence,
                   "With --upsample: leave computed pixels empty of which the network (du-mix) is "
                   "less sure; default: as the weights say")
      ->check(CLI::Range(0.0, 1.0));
  command->add_option("--threads", options.threads, "Threads (default: all cores)")
      ->check(CLI::Range(1, 256));
  command->add_flag("--loop-closing", options.loop_closing,
                    "Recognise places passed before and correct the path and the map");
  command->footer(
      "Writes into --out:\n"
      "  trajectory.tum    stamp x y z qx qy qz qw per scan\n"
      "  trajectory.kitti  3x4 matrix per scan, row-major; both in the first scan's sensor frame\n"
      "  map.pcd           the features of all key frames, in that frame\n"
      "  timings.json      time per stage and status of every scan\n"
      "  report.html       trajectory, error and times on one page\n"
      "An earlier run's results in it are replaced from the first scan on. Ctrl-C stops the run;\n"
      "what is written up to then is valid. Mapping says of every scan whether it was located:\n"
      "ok, degenerate (some direction of motion could not be seen), too few features, or not\n"
      "converged.");
}

RunResult run_and_write(const RunOptions& options, const InterruptGuard& interrupt) {
  if (options.threads > 0) {
    omp_set_num_threads(options.threads);
  }
  RunPlan plan = plan_of(options);
  const std::unique_ptr<ScanSource> source =
      open_input(input_recording(options), plan.recording_sensor);
  print_warnings(*source);
  const std::optional<TrajectoryFile> reference = reference_of(options, *source);
  RunOutput output(options.out);

  RunResult result;
  SlamRunSpec spec = plan.spec();
  spec.loop_closing = options.loop_closing;
  result.run = run_slam(*source, spec, output, interrupt);
  if (result.run.scans.empty()) {
    if (result.run.end == RunEnd::kUnreadableScan) {
      throw Error(result.run.end_message);
    }
    return result;  // interrupted at once: an earlier run's results stay
  }
  if (reference) {
    result.comparison = compare_with_reference(result.run.trajectory, *reference);
    if (!result.comparison) {
      fmt::print(stderr,
                 "hqslam: {}: fewer than 3 of its poses are within 0.02 s of a scan: not compared "
                 "with it\n",
                 reference->path);
    }
  }
  output.write_results(result.run, result.comparison);
  return result;
}

int run_command(const RunOptions& options) {
  const InterruptGuard interrupt;
  const RunResult result = run_and_write(options, interrupt);
  if (!result.run.scans.empty()) {
    print_summary(result, options);
  }
  return exit_status_of(result.run);
}

}  // namespace hqslam::tools
