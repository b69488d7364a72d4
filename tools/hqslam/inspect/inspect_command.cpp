#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "hqslam/core/npz.h"
#include "hqslam/core/scan_source.h"
#include "inspect/layers_page.h"
#include "inspect/slam_scan_page.h"
#include "inspect/what_if.h"
#include "pages/open_page.h"
#include "pages/page.h"
#include "product.h"
#include "recording/pose_check.h"
#include "recording/reading.h"
#include "recording/recording_choice.h"
#include "recording/scan_poses.h"
#include "run/slam_session.h"
#include "run/slam_settings.h"
#include "terminal/command_options.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

struct InspectOptions : InputChoice {  ///< sensor empty: as for hqslam upsample
  std::string weights;
  bool slam = false;  ///< what SLAM makes of it, not the network; weights: upsampled by it first
  int rows = 0;       ///< as UpsamplingChoice::rows
  SlamSettings slam_settings;
  std::string poses;  ///< for networks with a memory; empty: they have none of earlier scans
  std::int64_t scan = 0;
  std::vector<std::string> tensors;  ///< by name
  bool list = false;                 ///< print their names, write nothing
  bool reference = false;            ///< compare all of them with the reference
  std::vector<double> pixel;         ///< row and column of one to print, layer by layer; or empty
  std::vector<std::string> what_if;  ///< changes of the loop (what_if.h)
  std::string npz;                   ///< empty: tensors are not written
  std::string out;
  bool open = false;
};

/// Hands the scans up to the one that was asked for to `use`.
void for_scans_up_to(const InspectOptions& options, ScanSource& source,
                     const std::function<void(const ReadScan& read)>& use,
                     const LookAhead& look_ahead = {}) {
  print_warnings(source, options.input);
  const InterruptGuard interrupt;
  Reading reading;
  std::int64_t last = -1;
  const auto use_next = [&](const ReadScan& read) {
    last = read.index;
    if (last <= options.scan) use(read);
    return last < options.scan;
  };
  read_scans(source, interrupt, reading, use_next, look_ahead);
  if (last == options.scan) return;
  if (interrupt.stop_requested()) throw Error("inspect: interrupted after scan {}", last);
  if (reading.end == ReadingEnd::kUnreadableScan) throw Error(reading.end_message);
  if (reading.left_out.scans > 0) throw Error(reading.left_out.text());
  throw Error("{}: has {} scans, expected one with index {}", options.input, last + 1,
              options.scan);
}

/// The scan that was asked for, and what a network with a memory recalls in it.
struct SeenScan {
  RangeImage image;
  nn::RecalledImage recalled;
};

SeenScan scan_of(const InspectOptions& options, pipeline::UpsampledRecording& input) {
  const pipeline::Upsampler& upsampler = input.upsampler;
  require_memory(options.poses, upsampler.has_scan_memory());
  const auto reopened = [&] { return std::make_unique<recordings::Recording>(input.reopened()); };
  const ScanPoses poses = read_scan_poses(options.poses, InterruptGuard(), reopened);
  warn_of_wrong_poses(poses, options.poses, InterruptGuard(), reopened);
  pipeline::LookAheadMemory memory(upsampler.method(), poses);
  SeenScan seen;
  const auto look = [&](const ReadScan& read) {
    seen.recalled =
        memory.recall(upsampler.measured(read.scan.cloud), read.index, read.scan.stamp_s);
    if (read.index != options.scan) return;
    seen.image = range_image(calibrated(read.scan.cloud, upsampler.recorded()));
  };
  for_scans_up_to(options, input.recording, look, look_ahead_of(memory, upsampler));
  report_scans_without_pose(memory, options.poses, options.input);
  return seen;
}

void print_names(const nn::Trace& trace) {
  for (const nn::TracedTensor& tensor : trace.tensors()) {
    to_stdout("{}  {} x {} x {}  {}\n", tensor.name, tensor.channels(), tensor.rows(),
              tensor.columns(), tensor.unit);
  }
}

void print_differences(const std::vector<nn::ReferenceDifference>& differences) {
  to_stdout("{:<28} {:>12} {:>12}\n", "difference from reference", "largest", "rms");
  for (const nn::ReferenceDifference& difference : differences) {
    to_stdout("{:<28} {:>12.3g} {:>12.3g} {}\n", difference.name, difference.largest,
              difference.root_mean_square, difference.unit);
  }
}

/// Every tensor under its name: channels x rows x columns.
NpzArrays arrays_of(const nn::Trace& trace) {
  NpzArrays arrays;
  for (const nn::TracedTensor& tensor : trace.tensors()) {
    const std::span<const float> all = tensor.all();
    arrays[tensor.name] = npz_array(std::vector<float>(all.begin(), all.end()),
                                    {tensor.channels(), tensor.rows(), tensor.columns()});
  }
  return arrays;
}

void check_options(const InspectOptions& options) {
  if (options.weights.empty()) {
    throw Error("inspect: expected --weights or --slam, found neither; give --weights du-mix");
  }
  if (options.out.ends_with(".npz")) {
    throw Error("inspect: --out {} is for a page (.html); --npz {} writes the tensors", options.out,
                options.out);
  }
  for (const double number : options.pixel) {
    if (number == std::floor(number)) continue;
    throw Error("inspect: --pixel {}: expected whole numbers ROW,COLUMN",
                fmt::join(options.pixel, ","));
  }
  if (!options.npz.empty() && !options.npz.ends_with(".npz")) {
    throw Error("inspect: --npz {}: expected a name that ends with .npz", options.npz);
  }
  if (!options.out.empty()) {
    guard_output_file(options.out, {options.input, options.weights}, page_marker("hqslam inspect"));
  }
  if (!options.npz.empty() && (options.npz == options.weights || options.npz == options.input)) {
    throw Error("inspect: --npz {} is an input, expected another file", options.npz);
  }
}

/// What the network, and each that --what-if makes of it, does with the scan.
LayersReport report_of(const InspectOptions& options, const nn::Weights& weights,
                       const SeenScan& seen, const pipeline::Upsampler& upsampler) {
  nn::SuperResolver network(weights, {});  // its self-test was run when the recording was opened
  LayersReport report;
  report.recording = options.input;
  report.scan = options.scan;
  report.network = network.description();
  const auto& measured_rows = upsampler.selected_rows();
  report.measured = measured_rows ? select_rows(seen.image, *measured_rows) : seen.image;
  if (seen.image.rows == network.sensor().rows()) report.truth = seen.image;
  nn::UpsampledImage upsampled = network.run(report.measured, seen.recalled, &report.trace);
  report.result = std::move(upsampled.image);
  report.confidence = std::move(upsampled.confidence);
  if (!seen.recalled.is_empty()) report.without_memory = network.run(report.measured).image;
  for (const std::string& change : options.what_if) {
    nn::SuperResolver changed(what_if(weights, change), {});
    report.variants.push_back({change, changed.run(report.measured).image});
  }
  return report;
}

void write_page(const std::string& html, const InspectOptions& options) {
  write_text_file(html, options.out);
  to_stdout("results: {}\n", options.out);
  if (options.open) open_page(options.out);
}

/// SLAM up to one scan of the recording, and the page of that scan.
int inspect_slam(const InspectOptions& options) {
  guard_output_file(options.out, {options.input, options.weights},
                    page_marker("hqslam inspect --slam"));
  pipeline::UpsampledRecording input =
      upsampled_recording(options, {options.weights, options.rows});
  ScanSource& source = input.recording;
  pipeline::PipelineOptions pipeline;
  pipeline.slam_options = slam_options(options.slam_settings);
  SlamSession session(std::move(input.upsampler), pipeline, options.input);
  SlamScanReport page;
  page.recording = options.input;
  page.scan = options.scan;
  Progress progress("slam", options.scan + 1);
  const std::size_t printed = source.warnings().size();
  for_scans_up_to(options, source, [&](const ReadScan& read) {
    slam::ScanTrace* trace = read.index == options.scan ? &page.trace : nullptr;
    page.report = session.process(read.scan, read.index, read.reading_s, trace).report;
    progress.update(read.index + 1);
  });
  progress.finish();
  print_later_warnings(source, printed);
  write_page(slam_scan_html(page), options);
  return kOk;
}

void declare(CLI::App& app, InspectOptions& options) {
  Command command = add_command(
      app, "inspect",
      "Show the result of each layer of a network, or of each stage of SLAM, for a scan",
      "Prints what each layer of eq. 10 changes and, if the recording has all rows, its error. "
      "--out writes a page with H, Z, the filter's mask and Y of every layer. With --slam: the "
      "class of every pixel, features with their correspondences in the map, residuals and "
      "weights, the predicted, the odometry's and the final pose, and how well each direction of "
      "motion is determined.");
  declare_input(command, options, "Recording (as for hqslam upsample)");
  declare_imu(command, options);
  command
      .option("--weights", &options.weights, fmt::format("Network: {}", weights_help()),
              {.given = Given::kFile, .one_of = pipeline::installed_weights_names()})
      .option("--slam", &options.slam,
              "Show every stage of SLAM on the scan, after all scans before it; with --weights the "
              "scans are upsampled first")
      .option("--rows", &options.rows, kRowsHelp, {.within = kAnyCount})
      .option("--set", &options.slam_settings.set, "One option of SLAM, NAME=NUMBER",
              {.needs = {"--slam"}})
      .option("--poses", &options.poses, kMemoryPosesHelp,
              {.given = Given::kFile, .excludes = {"--slam"}})
      .option("--scan", &options.scan, "Index of the scan, from 0 (default: 0)",
              {.given = Given::kNotNegative})
      .option("--tensor", &options.tensors,
              "Show an inner tensor too, such as layers.2.encoder.0 (may be repeated)",
              {.excludes = {"--slam"}})
      .option("--list", &options.list, "Print the names of all inner tensors and nothing else")
      .option("--pixel", &options.pixel, "Follow this pixel, ROW,COLUMN, through all layers",
              {.delimiter = ',', .values = 2, .excludes = {"--slam"}})
      .option("--what-if", &options.what_if,
              "Also upsample with a changed loop: b=NUMBER, layers=N, y=zero, q=z, "
              "angle=DEGREES, pixels=N, no-q, literal, or several with commas (may be repeated)",
              {.excludes = {"--slam"}})
      .option("--npz", &options.npz, "File for all inner tensors by their names, for numpy",
              {.excludes = {"--slam", "--list"}})
      .option("--reference", &options.reference,
              "Compare every tensor with the network in double precision (takes seconds; a minute "
              "for a large network)",
              {.excludes = {"--slam"}})
      .option("--out", &options.out, "Page to write (.html)", {.excludes = {"--list"}});
  declare_open(command, options.open, {"--out"});
}

int run(const InspectOptions& options) {
  if (options.slam) {
    if (options.out.empty()) throw Error("inspect: no --out, expected a page to write");
    return inspect_slam(options);
  }
  check_options(options);
  pipeline::UpsampledRecording input =
      upsampled_recording(options, {options.weights, options.rows});
  const std::string file =
      pipeline::weights_file(options.weights, input.recording.sensor(), options.rows);
  nn::Weights weights = nn::read_weights(file);
  weights.description = input.upsampler.method()->network()->description();  // for this sensor
  const SeenScan seen = scan_of(options, input);
  LayersReport report = report_of(options, weights, seen, input.upsampler);
  report.weights = file;
  if (options.list) {
    print_names(report.trace);
    return kOk;
  }
  for (const std::string& name : options.tensors) report.trace.tensor(name);  // is there
  report.tensors = options.tensors;
  to_stdout("{}", figures_text(report));
  report.pixel.assign(options.pixel.begin(), options.pixel.end());
  if (!report.pixel.empty()) to_stdout("{}", pixel_text(report));
  if (options.reference) {
    report.differences =
        differences_from_reference(weights.description, weights.parameters, report.trace);
    print_differences(report.differences);
  }
  if (!options.npz.empty()) {
    write_npz(options.npz, arrays_of(report.trace));
    to_stdout("results: {}\n", options.npz);
  }
  if (!options.out.empty()) write_page(layers_html(report), options);
  return kOk;
}

}  // namespace

void add_inspect(CLI::App& app, Chosen& chosen) { add_subcommand<InspectOptions>(app, chosen); }

}  // namespace hqslam::tools
