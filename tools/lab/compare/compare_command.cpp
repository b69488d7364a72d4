#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>
#include <vector>

#include "compare/comparison_text.h"
#include "compare/other_scans_comparison.h"
#include "compare/upsampling_comparison.h"
#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "hqslam/core/projection.h"
#include "hqslam/nn/compare/compared_networks.h"
#include "hqslam/nn/weights_file.h"
#include "hqslam/pipeline/upsampler.h"
#include "laboratory.h"
#include "pages/text_table.h"
#include "recording/pose_check.h"
#include "recording/reading.h"
#include "recording/recording_choice.h"
#include "recording/scan_poses.h"
#include "terminal/command_options.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

using Json = nlohmann::ordered_json;

struct CompareOptions : InputChoice {
  std::vector<std::string> weights;
  std::string poses;  ///< for networks with a memory; empty: they have none of other scans
  bool no_look_ahead = false;
  int rows = 16;  ///< that are measured
  std::int64_t every = 1;
  std::string json;  ///< file to write; empty: none
  bool layers = false;
  int threads = 0;  ///< 0: what OpenMP chooses
};

/// The marker by which a file of --json is recognized.
constexpr const char* kJsonMarker = R"("written_by": "hqslam-lab compare")";

void guard_outputs(const CompareOptions& options) {
  Paths inputs = options.weights;
  inputs.push_back(options.input);
  if (!options.json.empty()) guard_output_file(options.json, inputs, kJsonMarker);
}

/// The recording's sensor, with as many of its columns as all networks for any sensor take.
SensorModel sensor_of(const CompareOptions& options) {
  SensorModel sensor = recordings::Recording::open(options.input, open_options(options)).sensor();
  int multiple = 1;
  for (const std::string& weights : options.weights) {
    const nn::NetworkDescription network =
        nn::read_weights(pipeline::weights_file(weights, sensor, options.rows),
                         nn::all_architectures())
            .description;
    if (fits_any_sensor(network)) multiple = std::lcm(multiple, column_multiple(network));
  }
  sensor.columns -= sensor.columns % multiple;
  return sensor;
}

/// A scan as it is compared: calibrated, in the sensor's columns.
OrganizedCloud compared(const OrganizedCloud& recorded, const SensorModel& sensor) {
  return calibrated(
      recorded.columns == sensor.columns ? recorded : project(returns_of(recorded), sensor).cloud,
      sensor);
}

/// The network of a weights file, if it is for scans such as the sensor's.
nn::SuperResolver network_of(const std::string& weights, const SensorModel& sensor, int rows,
                             nn::SuperResolverOptions options = {}) {
  options.architectures = nn::all_architectures();
  nn::SuperResolver network =
      nn::SuperResolver::load(pipeline::weights_file(weights, sensor, rows), options);
  if (fits_any_sensor(network.description())) {
    network = network.for_sensor(sensor, selection_for(sensor.rows(), rows));
  }
  const SensorModel& made_for = network.sensor();
  if (sensor.columns != made_for.columns || !have_same_beams(sensor, made_for)) {
    throw Error(
        "{}: expected weights for sensor '{}' ({} x {}), found weights for '{}' ({} x {}); the "
        "beams "
        "of both must agree within {} degrees; give weights made for that sensor",
        weights, sensor.name, sensor.rows(), sensor.columns, made_for.name, made_for.rows(),
        made_for.columns, kBeamTolerance_deg);
  }
  return network;
}

std::vector<ComparedMethod> methods_of(const CompareOptions& options, const SensorModel& sensor) {
  const RowSelection rows = selection_for(sensor.rows(), options.rows);
  std::vector<ComparedMethod> methods;
  for (const std::string& name : nn::interpolation_names()) {
    methods.push_back({name, {nn::interpolation_from_name(name), sensor, rows}});
  }
  std::vector<nn::Upsampler> networks;
  for (const std::string& weights : options.weights) {
    networks.emplace_back(network_of(weights, sensor, options.rows), sensor);
  }
  std::vector<std::string> kinds;
  for (const nn::Upsampler& network : networks) kinds.push_back(network.name());
  for (std::size_t i = 0; i < networks.size(); ++i) {
    nn::Upsampler& network = networks[i];
    const std::string& weights = options.weights[i];
    const bool is_alone = std::ranges::count(kinds, kinds[i]) == 1;
    const std::string name = is_alone ? kinds[i] : short_name(weights, options.weights);
    if (last_filter(network.network()->description())) {
      methods.push_back(
          {name + ", unfiltered",
           {network_of(weights, sensor, options.rows, {.filter_result = false}), sensor}});
    }
    methods.push_back({name, std::move(network)});
  }
  return methods;
}

/// Hands every `every`-th scan of the recording to `use`, with what a memory for `upsampler` has of
/// the scans before and after it. Returns how many.
template <typename Use>
std::int64_t for_each_scan(const CompareOptions& options, const SensorModel& sensor,
                           const InterruptGuard& interrupt, const Use& use,
                           const nn::Upsampler* upsampler = nullptr) {
  require_memory(options.poses, upsampler != nullptr && upsampler->has_scan_memory());
  const auto opened = [&] {
    return std::make_unique<recordings::Recording>(
        recordings::Recording::open(options.input, open_options(options)));
  };
  const ScanPoses poses = read_scan_poses(options.poses, interrupt, opened);
  warn_of_wrong_poses(poses, options.poses, interrupt, opened);
  const auto measured_of = [&](const OrganizedCloud& truth) {
    return select_rows(truth, selection_for(truth.rows, options.rows));
  };
  pipeline::LookAheadMemory memory(upsampler, poses, !options.no_look_ahead);
  const auto insert = [&](const ReadScan& read) {
    memory.insert(measured_of(compared(read.scan.cloud, sensor)), read.index, read.scan.stamp_s);
  };
  auto source = recordings::Recording::open(options.input, open_options(options));
  source.use_columns(sensor.columns);
  const std::size_t warnings_printed = print_warnings(source, options.input);
  Progress progress("compare", source.size());
  std::int64_t used = 0;
  std::int64_t scans_read = 0;
  Reading reading;
  reading.wanted = wanted_scans(options);
  const auto compare = [&](const ReadScan& read) {
    progress.update(++scans_read, source.read_share());
    const OrganizedCloud truth = compared(read.scan.cloud, sensor);
    const OrganizedCloud measured = measured_of(truth);
    const nn::RecalledImage recalled = memory.recall(measured, read.index, read.scan.stamp_s);
    if ((scans_read - 1) % options.every != 0) return true;
    if (points_of(measured).empty()) throw ScanError("has no return in the measured rows");
    use(truth, recalled);
    ++used;
    return true;
  };
  read_scans(source, interrupt, reading, compare, {memory.look_ahead_scans(), insert});
  progress.finish();
  print_later_warnings(source, warnings_printed);
  if (reading.end == ReadingEnd::kUnreadableScan) throw Error(reading.end_message);
  if (used == 0 && reading.left_out.scans > 0 && reading.end == ReadingEnd::kComplete) {
    throw Error(reading.left_out.text());
  }
  if (reading.left_out.scans > 0) to_stderr("hqslam-lab: {}\n", reading.left_out.text());
  report_scans_without_pose(memory, options.poses, options.input);
  return used;
}

void declare(CLI::App& app, CompareOptions& options) {
  Command command = add_command(
      app, "compare", "Compare methods of upsampling with what a recording has between their rows",
      "Methods: nearest, linear and inverse interpolation (linear in 1/range, by the beams'\n"
      "elevations), and each network, named by its kind or, where several are of that kind, by\n"
      "its file. A network with a filter at its end is also compared without that one\n"
      "(unfiltered); the filters inside stay. A line below each table defines each column.\n"
      "\n"
      "Of a recording without other rows the scans are located by SLAM, and the methods\n"
      "compared with what the scans before and after each measured between its rows.");
  declare_input(command, options,
                "Recording as for hqslam run, with all rows or with the measured ones alone");
  declare_scans(command, options);
  command
      .option("--weights", &options.weights,
              fmt::format("Networks to compare, each {}", weights_help()),
              {.given = Given::kFile, .one_of = pipeline::installed_weights_names()})
      .option("--poses", &options.poses, kMemoryPosesHelp, {.given = Given::kFile})
      .option("--no-look-ahead", &options.no_look_ahead,
              "Give the memory only the scans before each, as run and live do while they read",
              {.needs = {"--poses"}})
      .option("--rows", &options.rows, "Number of measured rows, evenly spread",
              {.shows_default = true, .within = kAnyCount})
      .option("--every", &options.every, "Compare every n-th scan (default: all)",
              {.within = kAnyCount})
      .option("--layers", &options.layers,
              "Compare, instead of methods, the results after each step of the first weights' "
              "layers (H: data step, Z: denoiser, Y: filter)",
              {.needs = {"--weights"}})
      .option("--json", &options.json, "Also write the figures into this file",
              {.excludes = {"--layers"}});
  declare_threads(command, options.threads);
}

void write_json(const CompareOptions& options, std::int64_t scans, const std::string& sensor,
                Json methods) {
  if (options.json.empty()) return;
  const Json json = {{"written_by", "hqslam-lab compare"},
                     {"input", options.input},
                     {"sensor", sensor},
                     {"scans", scans},
                     {"methods", std::move(methods)}};
  write_text_file(json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n", options.json);
}

/// Without rows between the measured ones: against what other scans of the drive measured there.
int compare_with_other_scans(CompareOptions options, const InterruptGuard& interrupt) {
  if (options.layers || !options.poses.empty() || !options.scans.empty() || options.every > 1) {
    throw Error(
        "{}: has no rows between the {} measured ones, so that its scans are located and compared "
        "with each other; leave --layers, --poses, --scans and --every out",
        options.input, options.rows);
  }
  const std::string weights = options.weights.empty() ? "du-mix" : options.weights.front();
  const RecordedDrive drive = read_recorded_drive(options, weights, interrupt);
  if (interrupt.stop_requested()) return kInterrupted;
  options.rows = select_rows(drive.sensor, drive.measured_rows).rows();
  const auto scores =
      compared_with_other_scans(methods_of(options, drive.sensor), drive, options.input);
  to_stdout("{}{} scans of {}\n", scores_text(scores), drive.scans.size(), options.input);
  write_json(options, std::ssize(drive.scans), drive.sensor.name, scores_json(scores));
  return kOk;
}

int run(const CompareOptions& options) {
  use_threads(options.threads);
  guard_outputs(options);
  const InterruptGuard interrupt;
  const SensorModel sensor = sensor_of(options);
  if (sensor.rows() <= options.rows) return compare_with_other_scans(options, interrupt);
  std::int64_t used = 0;
  if (options.layers) {
    LayerComparison comparison(network_of(options.weights.front(), sensor, options.rows), sensor);
    used = for_each_scan(options, sensor, interrupt,
                         [&](const OrganizedCloud& scan, const auto&) { comparison.add(scan); });
    to_stdout("{}", scores_text(comparison.scores()));
  } else {
    UpsamplingComparison comparison(methods_of(options, sensor));
    used = for_each_scan(
        options, sensor, interrupt,
        [&](const OrganizedCloud& scan, const nn::RecalledImage& recalled) {
          comparison.add(scan, recalled);
        },
        comparison.with_memory());
    if (used == 0 && interrupt.stop_requested()) return kInterrupted;
    to_stdout("{}", scores_text(comparison.scores()));
    write_json(options, used, sensor.name, scores_json(comparison.scores()));
  }
  to_stdout("{} scans of {}\n", used, options.input);
  return interrupt.stop_requested() ? kInterrupted : kOk;
}

}  // namespace

void add_compare(CLI::App& app, Chosen& chosen) { add_subcommand<CompareOptions>(app, chosen); }

}  // namespace hqslam::tools
