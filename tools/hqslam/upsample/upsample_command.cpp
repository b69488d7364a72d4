#include <fmt/format.h>
#include <fmt/ranges.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/evaluation/trajectory_error.h"
#include "product.h"
#include "recording/pose_check.h"
#include "recording/reading.h"
#include "recording/recording_choice.h"
#include "recording/scan_poses.h"
#include "terminal/command_options.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"
#include "timing/timing.h"
#include "upsample/upsample_output.h"

namespace hqslam::tools {
namespace {

/// sensor empty: as upsampled_input has it
struct UpsampleOptions : InputChoice, UpsamplingChoice {
  std::string poses;  ///< for networks with a memory; empty: they have none of earlier scans
  std::string out;
  int threads = 0;  ///< 0: what OpenMP chooses
  UpsampledFormats formats;
};

struct UpsampleRun : Reading {
  std::vector<double> times_s;  ///< of the upsampling alone, per scan
};

/// The corrections of the images that are written: ranges of the measured rows have them already,
/// and a computed row gets the elevation correction interpolated between them. measured: the sensor
/// of the measured rows.
void put_corrections(SensorModel& sensor, const SensorModel& measured) {
  sensor.elevation_correction_rad.clear();
  sensor.range_correction_m.clear();
  if (measured.elevation_correction_rad.empty()) return;
  const RowSelection rows = *sensor.measured_rows;
  for (int row = 0; row < sensor.rows(); ++row) {
    const double at = std::clamp(static_cast<double>(row - rows.offset) / rows.stride, 0.0,
                                 static_cast<double>(measured.rows() - 1));
    const int above = static_cast<int>(at);
    const int below = std::min(above + 1, measured.rows() - 1);
    sensor.elevation_correction_rad.push_back(std::lerp(measured.elevation_correction_rad[above],
                                                        measured.elevation_correction_rad[below],
                                                        at - above));
    sensor.range_correction_m.push_back(0.0);
  }
}

UpsampleOutput make_output(const UpsampleOptions& options, const pipeline::Upsampler& upsampler,
                           const OrganizedCloud& first, std::optional<std::int64_t> scans) {
  SensorModel sensor = upsampler.sensor();
  put_corrections(sensor, upsampler.measured_sensor());
  sensor.motion_corrected = first.time_offset_s.empty();
  return {options.out,
          {options.input, options.upsample, scans, options.poses},
          sensor,
          options.formats};
}

/// The ranges that are written are those of the points: measured rows are the recording's.
UpsampleRun upsample(ScanSource& source, pipeline::Upsampler& upsampler, const ScanPoses& poses,
                     const UpsampleOptions& options, const InterruptGuard& interrupt) {
  std::optional<UpsampleOutput> output;  // made when the first scan is there
  pipeline::LookAheadMemory memory(upsampler.method(), poses);
  UpsampleRun run;
  run.wanted = wanted_scans(options);
  Progress progress(
      fmt::format("upsample to {}x{}", upsampler.sensor().rows(), upsampler.sensor().columns),
      run.wanted.count_of(source.size()));
  const auto upsample = [&](const ReadScan& read) {
    const OrganizedCloud measured = upsampler.measured(read.scan.cloud);
    OrganizedCloud cloud;
    const double time_s = seconds_of([&] {
      cloud = upsampler.upsampled(measured, memory.recall(measured, read.index, read.scan.stamp_s));
    });
    if (!output) output.emplace(make_output(options, upsampler, cloud, source.size()));
    output->append(range_image(cloud), cloud, read.scan.stamp_s);
    run.times_s.push_back(time_s);
    progress.update(std::ssize(run.times_s), source.read_share());
    return true;
  };
  read_scans(source, interrupt, run, upsample, look_ahead_of(memory, upsampler));
  progress.finish();
  if (output && run.end == ReadingEnd::kComplete) {
    output->finish(std::ssize(run.times_s) + run.left_out.scans);
  }
  report_scans_without_pose(memory, options.poses, options.input);
  return run;
}

void print_summary(const UpsampleRun& run, const nn::Upsampler& upsampler,
                   const UpsampleOptions& options) {
  to_stdout("{} scans, {} rows -> {} rows of {} columns, by {}", run.times_s.size(),
            upsampler.measured_sensor().rows(), upsampler.sensor().rows(),
            upsampler.sensor().columns, upsampler.name());
  if (const nn::SuperResolver* network = upsampler.network()) {
    to_stdout(" ({} parameters, {:.3f} GMAC a scan)", network->parameters(),
              1e-9 * static_cast<double>(network->multiply_adds()));
  }
  const double median_s = statistics_of(run.times_s).median;
  to_stdout("\nupsampling alone: {:.2f} ms a scan, {:.1f} scans/s (median, {} thread{})\n",
            1e3 * median_s, 1.0 / median_s, omp_get_max_threads(),
            omp_get_max_threads() == 1 ? "" : "s");
  const auto if_there = [&](const char* name) {
    const bool there = std::filesystem::exists(std::filesystem::path(options.out) / name);
    return there ? fmt::format(", {}", name) : "";
  };
  to_stdout("results: {}/scans.npy{}{}, sensor.json, upsample.json{}{}\n", options.out,
            if_there("confidence.npy"), if_there("intensity.npy"),
            options.formats.kitti_bin ? ", bin" : "", options.formats.pcd ? ", pcd" : "");
}

void declare(CLI::App& app, UpsampleOptions& options) {
  Command command =
      add_command(app, "upsample", "Compute the rows between those of a LiDAR with few beams",
                  "Writes into --out, which hqslam run reads as it is:\n"
                  "  scans.npy          N x rows x columns, float32 metres\n"
                  "  confidence.npy     0 to 1 per pixel, of a network that gives a confidence\n"
                  "  intensity.npy      where the recording has intensities\n"
                  "  timestamps.txt     stamp of each scan, seconds\n"
                  "  first_columns.txt  of sensors that begin a turn at any column\n"
                  "  sensor.json, upsample.json, and the truth of a simulated drive\n"
                  "Ctrl-C stops; what is written up to then is valid.");
  declare_input(command, options,
                "Recording as for hqslam run, with the measured rows alone or with all rows of the "
                "sensor, of which the measured ones are used",
                "Sensor of the recording (name or .json file; for interpolation with all rows); "
                "default: determined from the recording, or that of the weights");
  command.alternatives("Method", "One of")
      .option("--weights", &options.upsample, fmt::format("Network: {}", weights_help()),
              {.given = Given::kFile, .one_of = pipeline::installed_weights_names()})
      .option("--method", &options.upsample,
              "Interpolation between the measured rows; by default every fourth row of the "
              "sensor is measured",
              {.one_of = nn::interpolation_names()});
  command.option("--rows", &options.rows, kRowsHelp, {.within = kAnyCount});
  command.option("--out", &options.out, "Folder for the results; made if it does not exist",
                 {.required = true});
  declare_scans(command, options);
  declare_computed_rows(command, options);
  command.option("--poses", &options.poses, kMemoryPosesHelp, {.given = Given::kFile});
  declare_threads(command, options.threads);
  command.option("--bin", &options.formats.kitti_bin, "Also write KITTI .bin files")
      .option("--pcd", &options.formats.pcd, "Also write .pcd files");
}

int run(const UpsampleOptions& options) {
  const InterruptGuard interrupt;
  use_threads(options.threads);
  refuse_to_write_into_recording(options.input, options.out);
  pipeline::UpsampledRecording input = upsampled_recording(options, options);
  require_memory(options.poses, input.upsampler.has_scan_memory());
  if (options.poses.empty() && input.upsampler.has_scan_memory()) {
    to_stderr("hqslam: {} recalls no earlier scan without poses; give --poses\n", options.upsample);
  }
  const auto reopened = [&] { return std::make_unique<recordings::Recording>(input.reopened()); };
  const ScanPoses poses = read_scan_poses(options.poses, interrupt, reopened);
  warn_of_wrong_poses(poses, options.poses, interrupt, reopened);
  ScanSource& source = input.recording;
  const std::size_t printed = print_warnings(source, options.input);
  const UpsampleRun run = upsample(source, input.upsampler, poses, options, interrupt);
  print_later_warnings(source, printed);
  if (!run.times_s.empty()) print_summary(run, *input.upsampler.method(), options);
  return exit_status_of(run, std::ssize(run.times_s), source.size());
}

}  // namespace

void add_upsample(CLI::App& app, Chosen& chosen) { add_subcommand<UpsampleOptions>(app, chosen); }

}  // namespace hqslam::tools
