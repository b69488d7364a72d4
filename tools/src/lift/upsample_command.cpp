#include <fmt/format.h>
#include <omp.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "commands.h"
#include "hqslam/core/error.h"
#include "hqslam/core/scan_source.h"
#include "hqslam/nn/upsampled_cloud.h"
#include "lift/upsample_output.h"
#include "lift/upsampling_plan.h"
#include "recording/recording_sensor.h"
#include "terminal/exit_status.h"
#include "terminal/interrupt.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"
#include "timing/stopwatch.h"
#include "timing/timing_statistics.h"

namespace hqslam::tools {
namespace {

struct UpsampleRun {
  std::vector<double> times_s;                     ///< of the upsampling alone, per scan
  std::optional<std::int64_t> scans_in_recording;  ///< nothing where only its end tells
  bool interrupted = false;
  LeftOut left_out;
  std::optional<std::string> unreadable;  ///< the reader's message for the scan that ended the run
};

/// `stream`: the recording, if it is a capture or a bag.
UpsamplingPlan plan_of(const UpsampleOptions& options, const recordings::StreamSource* stream) {
  UpsamplingRequest request;
  if (stream != nullptr) request.sender = stream->sensor();
  request.input = options.input;
  request.sensor = options.sensor;
  request.stream = options.stream;
  request.method = options.weights.empty() ? options.method : options.weights;
  request.confidence = options;
  return plan_upsampling(request);
}

/// The next scan, or nothing at the end of the recording or at a scan that cannot be read, unless
/// it is the first: then throws Error.
std::optional<RecordedScan> read_next(ScanSource& source, UpsampleRun& run) {
  try {
    return next_usable(source, run.left_out);
  } catch (const Error& error) {
    if (run.times_s.empty()) {
      throw;
    }
    run.unreadable = error.what();
    return std::nullopt;
  }
}

/// The ranges of the points that are written: those of the measured rows are the recording's.
UpsampleRun upsample(ScanSource& source, UpsamplingPlan& plan, const UpsampleOptions& options,
                     const InterruptGuard& interrupt) {
  std::optional<UpsampleOutput> output;  // made when the first scan is there
  UpsampleRun run;
  run.scans_in_recording = source.size();
  Progress progress(fmt::format("upsample to {}x{}", plan.upsampler.sensor().rows(),
                                plan.upsampler.sensor().columns),
                    source.size());
  while (true) {
    run.interrupted = interrupt.stop_requested();
    if (run.interrupted) break;
    const std::optional<RecordedScan> scan = read_next(source, run);
    if (!scan) break;
    const OrganizedCloud measured = plan.rows ? select_rows(scan->cloud, *plan.rows) : scan->cloud;
    const RangeImage measured_image = range_image(measured);
    nn::LiftedImage lifted;
    run.times_s.push_back(seconds_of([&] { lifted = plan.upsampler.run(measured_image); }));
    const OrganizedCloud cloud = nn::upsampled_cloud(
        lifted, measured, plan.upsampler.measured_rows(), plan.upsampler.sensor());
    if (!output) {
      SensorModel sensor = plan.upsampler.sensor();
      sensor.motion_corrected = cloud.time_offset_s.empty();
      output.emplace(options.out, options.input,
                     options.weights.empty() ? options.method : options.weights, sensor,
                     UpsampledFormats{options.bin, options.pcd, options.png});
    }
    output->append(range_image(cloud), cloud, scan->stamp_s);
    progress.update(std::ssize(run.times_s), source.read_share());
  }
  progress.update(std::ssize(run.times_s), source.read_share());
  progress.finish();
  return run;
}

void print_summary(const UpsampleRun& run, const UpsamplingPlan& plan,
                   const UpsampleOptions& options) {
  const nn::Upsampler& upsampler = plan.upsampler;
  to_stdout("{} scans, {} rows -> {} rows of {} columns, by {}", run.times_s.size(),
            select_rows(upsampler.sensor(), upsampler.measured_rows()).rows(),
            upsampler.sensor().rows(), upsampler.sensor().columns, upsampler.name());
  if (const nn::SuperResolver* network = upsampler.network()) {
    to_stdout(" ({} parameters, {:.3f} GMAC a scan)", network->parameters(),
              1e-9 * static_cast<double>(network->multiply_adds()));
  }
  const double median_s = distribution_of(run.times_s).median;
  to_stdout("\nupsampling alone: {:.2f} ms a scan, {:.1f} scans/s (median, {} thread{})\n",
            1e3 * median_s, 1.0 / median_s, omp_get_max_threads(),
            omp_get_max_threads() == 1 ? "" : "s");
  const bool sure =
      upsampler.network() != nullptr && has_confidence(upsampler.network()->description());
  to_stdout("results: {}/scans.npy{}, sensor.json, upsample.json{}{}{}\n", options.out,
            sure ? ", confidence.npy" : "", options.bin ? ", bin" : "", options.pcd ? ", pcd" : "",
            options.png ? ", png" : "");
}

}  // namespace

void declare_upsample(CLI::App& app, UpsampleOptions& options) {
  CLI::App* command =
      app.add_subcommand("upsample", "Fill the rows between those of a LiDAR with few beams");
  declare_input(*command, options,
                "Recording as for hqslam run: the measured rows alone, or all rows of the sensor, "
                "of which the measured ones are looked at",
                "Sensor of the recording (name or .json file); default: what the recording says, "
                "or the one that the weights were made for. For interpolation: with all rows");
  CLI::Option_group* method = command->add_option_group("How", "One of");
  method->add_option("--weights", options.weights, "Trained network (.npz)")
      ->check(CLI::ExistingFile);
  method->add_option("--method", options.method, "Interpolation, of every fourth row")
      ->check(CLI::IsMember(nn::interpolation_names()));
  method->require_option(1);
  command->add_option("--out", options.out, "Folder for the results; made if it is not there")
      ->required();
  declare_confidence(*command, options);
  declare_threads(*command, options.threads);
  command->add_flag("--bin", options.bin, "Also write KITTI .bin files");
  command->add_flag("--pcd", options.pcd, "Also write .pcd files");
  command->add_flag("--png", options.png, "Also write pictures of the range images");
  command->footer(
      "Writes into --out: scans.npy (N x rows x columns, float32 metres), confidence.npy (of a\n"
      "network that says how sure it is, 0 to 1 per pixel), timestamps.txt, sensor.json,\n"
      "upsample.json (where it came from), and the truth of a simulated drive. hqslam run takes "
      "the\n"
      "folder as it is. Ctrl-C stops; what is written up to then is valid.");
}

int upsample_command(const UpsampleOptions& options) {
  const InterruptGuard interrupt;
  use_threads(options.threads);
  refuse_to_write_into_recording(options.input, options.out);
  auto stream = open_stream(options);
  UpsamplingPlan plan = plan_of(options, stream.get());
  if (stream) stream->use_columns(plan.recording_sensor.columns);
  const std::unique_ptr<ScanSource> source =
      stream ? std::move(stream) : open_input(options, plan.recording_sensor);
  print_warnings(*source, options.input);
  const std::size_t told = source->warnings().size();
  const UpsampleRun run = upsample(*source, plan, options, interrupt);
  print_later_warnings(*source, told);
  const auto scans = static_cast<std::int64_t>(run.times_s.size());
  if (scans > 0) {
    print_summary(run, plan, options);
  } else if (run.left_out.scans > 0 && !interrupt.stop_requested()) {
    throw Error(run.left_out.text());
  }
  if (run.left_out.scans > 0) to_stderr("hqslam: {}\n", run.left_out.text());
  const std::string of =
      run.scans_in_recording ? fmt::format(" of {}", *run.scans_in_recording) : "";
  if (run.unreadable) {
    to_stderr("hqslam: {}; stopped after {}{} scans, the results up to there are valid\n",
              *run.unreadable, scans, of);
    return kWrongInput;
  }
  if (run.interrupted && scans + run.left_out.scans != run.scans_in_recording) {
    to_stderr("hqslam: interrupted after {}{} scans; the results up to there are valid\n", scans,
              of);
    return kInterrupted;
  }
  return kOk;
}

}  // namespace hqslam::tools
