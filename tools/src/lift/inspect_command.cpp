#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "commands.h"
#include "files/output_guard.h"
#include "files/text_file.h"
#include "hqslam/core/error.h"
#include "hqslam/core/scan_source.h"
#include "inspect_slam/inspect_slam.h"
#include "lift/layers_report.h"
#include "lift/lifted_input.h"
#include "recording/reading.h"
#include "recording/recording_sensor.h"
#include "terminal/exit_status.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

RangeImage scan_of(const InspectOptions& options, const SensorModel& sensor) {
  const auto source = open_input(options, sensor);
  print_warnings(*source, options.input);
  LeftOut left_out;
  std::optional<RecordedScan> scan;
  for (std::int64_t i = 0; i <= options.scan; ++i) {
    scan = next_usable(*source, left_out);
    if (!scan) {
      throw Error(fmt::format("{}: has {} scans{}, expected one with index {}", options.input, i,
                              left_out.scans > 0 ? " that can be used" : "", options.scan));
    }
  }
  return range_image(scan->cloud);
}

void print_names(const nn::Trace& trace) {
  for (const nn::TracedTensor& tensor : trace.tensors()) {
    to_stdout("{}  {} x {} x {}  {}\n", tensor.name, tensor.channels, tensor.rows, tensor.columns,
              tensor.unit);
  }
}

void print_differences(const std::vector<nn::ReferenceDifference>& differences) {
  to_stdout("{:<28} {:>12} {:>12}\n", "difference from reference", "largest", "rms");
  for (const nn::ReferenceDifference& difference : differences) {
    to_stdout("{:<28} {:>12.3g} {:>12.3g} {}\n", difference.name, difference.largest,
              difference.root_mean_square, difference.unit);
  }
}

}  // namespace

void declare_inspect(CLI::App& app, InspectOptions& options) {
  CLI::App* command =
      app.add_subcommand("inspect", "Show what a network, or SLAM, makes of one scan");
  declare_input(*command, options, "Recording (as for hqslam upsample)");
  command->add_option("--weights", options.weights, "Weights file");
  CLI::Option* slam = command->add_flag(
      "--slam", options.slam,
      "Show instead what every stage of SLAM makes of the scan, after all scans before it; with "
      "--weights the scans are lifted first");
  command->add_option("--rows", options.rows, "Use only this many of the sensor's rows")
      ->check(CLI::Range(1, 1000000000))
      ->needs(slam);
  command->add_option("--set", options.slam_settings.set, "One option of SLAM, NAME=NUMBER")
      ->needs(slam);
  command->add_option("--scan", options.scan, "Which scan, counted from 0 (default: the first)")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--tensor", options.tensors,
                      "Show an inner tensor too, such as layers.2.encoder.0 (may be repeated)");
  CLI::Option* const list =
      command->add_flag("--list", options.list, "Print the names of all inner tensors, no page");
  command->add_flag("--reference", options.reference,
                    "How far every tensor is from the network in double precision (minutes)");
  command->add_option("--out", options.out, "Page to write (.html)")->excludes(list);
  command->footer(
      "Writes one page with H, Z, the filter's mask and Y of every layer, the terms of the "
      "objective\n"
      "and, if the recording has all rows, the error of every layer.\n"
      "With --slam: the class of every pixel, features, what each was matched with in the map, "
      "its\n"
      "residual and weight, the expected, the odometry's and the found pose, and how much is "
      "known\n"
      "about each direction of motion.");
}

int inspect_command(const InspectOptions& options) {
  if (options.slam) {
    if (options.out.empty()) throw Error("inspect: no --out, expected a page to write");
    return inspect_slam(options);
  }
  if (options.weights.empty()) throw Error("inspect: expected --weights, or --slam");
  if (!options.list) {
    if (options.out.empty()) throw Error("inspect: no --out, expected a page to write or --list");
    guard_output_file(options.out, {options.input, options.weights},
                      [](const auto& path) { return has_marker(path, kLayersPageMarker); });
  }
  const LiftedInput input = lifted_input(options, {options.weights});
  nn::SuperResolver network = nn::SuperResolver::load(options.weights);
  const RangeImage scan = scan_of(options, input.recorded);
  LayersReport report;
  report.recording = options.input;
  report.weights = options.weights;
  report.scan = options.scan;
  report.min_range_m = network.sensor().min_range_m;
  report.max_range_m = network.sensor().max_range_m;
  report.network = network.description();
  report.measured = input.rows ? select_rows(scan, *input.rows) : scan;
  if (scan.rows == network.sensor().rows()) report.truth = scan;
  nn::LiftedImage lifted = network.run(report.measured, &report.trace);
  if (options.list) {
    print_names(report.trace);
    return kOk;
  }
  for (const std::string& name : options.tensors) report.trace.tensor(name);  // is there
  report.tensors = options.tensors;
  if (options.reference) {
    const nn::Weights weights = nn::read_weights(options.weights);
    report.differences =
        differences_from_reference(weights.description, weights.parameters, report.trace);
    print_differences(report.differences);
  }
  report.result = std::move(lifted.image);
  report.confidence = std::move(lifted.confidence);
  write_text_file(layers_html(report), options.out);
  to_stdout("results: {}\n", options.out);
  return kOk;
}

}  // namespace hqslam::tools
