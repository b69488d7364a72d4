#include <fmt/format.h>
#include <omp.h>
#include <stdlib.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/bench_measurement.h"
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
};

namespace fs = std::filesystem;

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

/// Tables of the times of the networks that take the images.
std::string measure_networks(const std::vector<std::string>& paths,
                             const std::vector<RangeImage>& images,
                             const InterruptGuard& interrupt) {
  std::string text;
  for (const std::string& path : paths) {
    if (interrupt.stop_requested()) break;
    const nn::Weights weights = nn::read_weights(path, nn::all_architectures());
    if (!takes(weights, images)) {
      to_stderr("{}: left out, the network takes images of {} x {}\n", path,
                weights.description.sensor.rows(), weights.description.sensor.columns);
      continue;
    }
    to_stderr("network {} ...\n", nn::name(weights.description));
    text += network_text(time_network(weights, images, kMostThreads, interrupt));
  }
  return text;
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

SlamTiming measure_slam(const std::string& drive, const pipeline::UpsamplingOptions& upsampling,
                        int threads, const InterruptGuard& interrupt) {
  auto input = pipeline::open_upsampled(drive, {}, upsampling);
  const nn::Upsampler* method = input.upsampler.method();
  to_stderr("slam, {} rows{}, {} thread{} ...\n", input.upsampler.measured_sensor().rows(),
            method != nullptr ? fmt::format(" upsampled by {}", method->name()) : "", threads,
            threads > 1 ? "s" : "");
  return time_slam(std::move(input), threads, interrupt);
}

/// Tables of all times; nothing once SLAM is interrupted. drive: the folder of a simulated drive
/// with `scans` scans.
std::string measure(const std::string& drive, std::int64_t scans,
                    const std::vector<std::string>& weights, const InterruptGuard& interrupt) {
  const std::vector<pipeline::UpsamplingOptions> inputs = slam_inputs(weights);
  std::vector<SlamTiming> timings;
  for (int threads = 1; threads <= kMostThreads; ++threads) {
    for (const pipeline::UpsamplingOptions& upsampling : inputs) {
      if (interrupt.stop_requested()) return {};
      timings.push_back(measure_slam(drive, upsampling, threads, interrupt));
    }
  }
  auto source = recordings::Recording::open(drive);
  const std::vector<RangeImage> images = sample_images(source, scans);
  return fmt::format("simulated {}, {} scans, sensor {}, {} cores\n\n", kDrive, scans, kSensor,
                     omp_get_num_procs()) +
         slam_text(timings) + measure_networks(weights, images, interrupt);
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
              {.given = Given::kFile});
}

int run(const BenchOptions& options) {
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
  const std::string tables = measure(drive.out, options.scans, weights, interrupt);
  if (interrupt.stop_requested()) {
    to_stderr("hqslam-lab: interrupted\n");
    return kInterrupted;
  }
  to_stdout("{}", tables);
  return kOk;
}

}  // namespace

void add_bench(CLI::App& app, Chosen& chosen) { add_subcommand<BenchOptions>(app, chosen); }

}  // namespace hqslam::tools
