#include <fmt/format.h>
#include <fmt/ranges.h>
#include <omp.h>
#include <stdlib.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/bench_measurement.h"
#include "bench/bench_text.h"
#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "hqslam/core/scan_source.h"
#include "hqslam/nn/compare/compared_networks.h"
#include "hqslam/nn/instruction_set.h"
#include "hqslam/nn/weights_file.h"
#include "laboratory.h"
#include "recording/recording_choice.h"
#include "simulate/simulate_command.h"
#include "terminal/command_options.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

struct BenchOptions {
  std::int64_t scans = 200;          ///< of a simulated drive
  std::vector<std::string> weights;  ///< empty: those that come with the program
  bool json = false;
  bool cpu = false;  ///< print only which instruction set is in use
};

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kDrive = "block";
constexpr const char* kSensor = "os1-64";
constexpr std::array<int, 2> kRowCounts = {64, 16};
constexpr int kMostThreads = 2;
constexpr std::size_t kImages = 20;  ///< that networks upsample

/// Makes a new folder.
std::string temporary_folder() {
  std::string name = (fs::temp_directory_path() / "hqslam-bench-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) {
    throw Error("{}: cannot make this folder for the simulated drive; set TMPDIR", name);
  }
  return name;
}

/// Networks that come with the program, which are measured by default.
constexpr std::array<const char*, 4> kInstalledNetworks = {
    "du-mix_any-beams.npz", "du-mix-memory_os1_16to64.npz", "du-or_os1_16to64.npz",
    "simple-du_os1_16to64.npz"};

std::vector<std::string> weights_of(const BenchOptions& options) {
  std::vector<std::string> paths = options.weights;
  for (const char* name : kInstalledNetworks) {
    if (const std::optional<std::string> path = pipeline::installed_weights(name);
        path && options.weights.empty()) {
      paths.push_back(*path);
    }
  }
  return paths;
}

/// Images from all over the recording.
std::vector<RangeImage> sample_images(ScanSource& source, std::int64_t scans) {
  const std::int64_t stride = std::max<std::int64_t>(1, scans / static_cast<std::int64_t>(kImages));
  std::vector<RangeImage> images;
  for (std::int64_t i = 0; images.size() < kImages; ++i) {
    const std::optional<RecordedScan> scan = source.next();
    if (!scan) break;
    if (i % stride == 0) images.push_back(range_image(scan->cloud));
  }
  return images;
}

/// Adds what time_network measures.
void measure_networks(const std::vector<std::string>& paths, const std::vector<RangeImage>& images,
                      const InterruptGuard& interrupt, Json& measured) {
  for (const std::string& path : paths) {
    if (interrupt.stop_requested()) return;
    const nn::Weights weights = nn::read_weights(path, nn::all_architectures());
    if (!takes(weights, images)) {
      to_stderr("{}: left out, the network takes images of {} x {}\n", path,
                weights.description.sensor.rows(), weights.description.sensor.columns);
      continue;
    }
    to_stderr("network {} ...\n", nn::name(weights.description));
    measured["networks"].push_back(time_network(path, weights, images, kMostThreads, interrupt));
  }
}

/// What SLAM is measured with: kRowCounts of the sensor's rows, then all rows by the networks of
/// this sensor that are quick enough to stand before SLAM.
std::vector<pipeline::UpsamplingOptions> slam_inputs(const std::vector<std::string>& paths) {
  constexpr std::int64_t kMostMultiplyAdds = 5'000'000'000;
  const SensorModel sensor = sensor_preset(kSensor);
  std::vector<pipeline::UpsamplingOptions> inputs;
  for (const int rows : kRowCounts) inputs.push_back({.rows = rows});
  for (const std::string& path : paths) {
    const nn::SuperResolver network =
        nn::SuperResolver::load(path, {.architectures = nn::all_architectures()});
    if (network.multiply_adds() < kMostMultiplyAdds && network.sensor().rows() == sensor.rows() &&
        network.sensor().columns == sensor.columns) {
      inputs.push_back({.method = path, .rows = kRowCounts.back()});
    }
  }
  return inputs;
}

Json measure_slam(const std::string& drive, const pipeline::UpsamplingOptions& upsampling,
                  int threads, const InterruptGuard& interrupt) {
  auto input = pipeline::open_upsampled(drive, {}, upsampling);
  const nn::Upsampler* method = input.upsampler.method();
  to_stderr("slam, {} rows{}, {} thread{} ...\n", input.upsampler.measured_sensor().rows(),
            method != nullptr ? fmt::format(" upsampled by {}", method->name()) : "", threads,
            threads > 1 ? "s" : "");
  return time_slam(std::move(input), threads, interrupt);
}

/// What --json prints. drive: the folder of a simulated drive with `scans` scans.
Json measure(const std::string& drive, std::int64_t scans, const std::vector<std::string>& weights,
             const InterruptGuard& interrupt) {
  Json measured = {{"input", fmt::format("simulated {}, {} scans", kDrive, scans)},
                   {"sensor", kSensor},
                   {"cores", omp_get_num_procs()},
                   {"slam", Json::array()},
                   {"networks", Json::array()}};
  const std::vector<pipeline::UpsamplingOptions> inputs = slam_inputs(weights);
  for (int threads = 1; threads <= kMostThreads; ++threads) {
    for (const pipeline::UpsamplingOptions& upsampling : inputs) {
      if (interrupt.stop_requested()) return measured;
      measured["slam"].push_back(measure_slam(drive, upsampling, threads, interrupt));
    }
  }
  auto source = recordings::Recording::open(drive);
  const std::vector<RangeImage> images = sample_images(source, scans);
  measure_networks(weights, images, interrupt, measured);
  return measured;
}

std::string text_of(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// Prints the instruction sets that networks can use here and the one that they use.
void print_instruction_sets(bool as_json) {
  const std::string_view chosen = nn::name(nn::chosen_instruction_set());
  std::vector<std::string_view> available;
  for (const nn::InstructionSet set : nn::available_instruction_sets()) {
    available.push_back(nn::name(set));
  }
  if (as_json) {
    to_stdout("{}", text_of({{"instruction_set", chosen}, {"available", available}}));
    return;
  }
  to_stdout("in use:    {}\navailable: {}\n", chosen, fmt::join(available, ", "));
}

void declare(CLI::App& app, BenchOptions& options) {
  Command command = add_command(
      app, "bench", "Measure the times of SLAM's stages and of networks, with one thread and two");
  command
      .option("--scans", &options.scans, "Length of the simulated drive to measure on",
              {.shows_default = true, .within = kAnyCount})
      .option("--weights", &options.weights,
              "Trained network to measure (.npz), may be repeated (default: the networks that come "
              "with hqslam)",
              {.given = Given::kFile})
      .option("--json", &options.json, "Print JSON instead of a table")
      .option("--cpu", &options.cpu,
              "Only print the available instruction sets and the one that networks use; "
              "HQSLAM_INSTRUCTION_SET=NAME chooses another");
}

int run(const BenchOptions& options) {
  if (options.cpu) {
    print_instruction_sets(options.json);
    return kOk;
  }
  const InterruptGuard interrupt;
  const std::vector<std::string> weights = weights_of(options);
  nn::chosen_instruction_set();  // an unknown one is refused before the work
  const RemovedAtEnd folder(temporary_folder());
  SimulateOptions drive;
  drive.drive = kDrive;
  drive.sensor = kSensor;
  drive.scans = options.scans;
  drive.out = folder.path.string();
  simulate_drive(drive, interrupt);
  const Json measured = measure(drive.out, options.scans, weights, interrupt);
  if (interrupt.stop_requested()) {
    to_stderr("hqslam-lab: interrupted\n");
    return kInterrupted;
  }
  to_stdout("{}", options.json ? text_of(measured) : bench_text(measured));
  return kOk;
}

}  // namespace

void add_bench(CLI::App& app, Chosen& chosen) { add_subcommand<BenchOptions>(app, chosen); }

}  // namespace hqslam::tools
