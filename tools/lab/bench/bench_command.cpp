#include "bench/bench_command.h"

#include <fmt/format.h>
#include <omp.h>
#include <stdlib.h>

#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "bench/bench_measurement.h"
#include "bench/bench_network.h"
#include "files/installed_weights.h"
#include "files/result_files.h"
#include "hqslam/core/error.h"
#include "hqslam/core/scan_source.h"
#include "hqslam/nn/compare/compared_networks.h"
#include "hqslam/nn/weights_file.h"
#include "hqslam/sim/drive.h"
#include "printing/printed_table.h"
#include "recording/recording_choice.h"
#include "simulate/simulate_command.h"
#include "terminal/command_options.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::array<int, 2> kRowCounts = {64, 16};
constexpr int kMostThreads = 2;
constexpr std::size_t kStepImages = 20;

/// Makes a new folder.
std::string temporary_folder() {
  std::string name = (fs::temp_directory_path() / "hqslam-bench-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) {
    throw Error("{}: cannot make this folder for the simulated drive; set TMPDIR", name);
  }
  return name;
}

struct Measurements {
  std::string input;
  std::string sensor;
  std::vector<SlamTiming> slam;
  int step_images = 0;
  StepTiming steps;
  std::vector<MultiplyAddPeak> peaks;
  std::vector<NetworkTiming> networks;
};

/// Networks that come with the program, which are measured by default.
constexpr std::array<const char*, 4> kInstalledNetworks = {
    "du-mix_os1_16to64.npz", "du-mix-memory_os1_16to64.npz", "du-or_os1_16to64.npz",
    "simple-du_os1_16to64.npz"};

std::vector<std::string> weights_of(const BenchOptions& options) {
  std::vector<std::string> paths = options.weights;
  for (const char* name : kInstalledNetworks) {
    if (const std::optional<std::string> path = installed_weights(name);
        path && options.weights.empty()) {
      paths.push_back(*path);
    }
  }
  return paths;
}

/// Images from all over the recording.
std::vector<RangeImage> sample_images(ScanSource& source, std::int64_t scans) {
  const std::int64_t stride =
      std::max<std::int64_t>(1, scans / static_cast<std::int64_t>(kStepImages));
  std::vector<RangeImage> images;
  for (std::int64_t i = 0; images.size() < kStepImages; ++i) {
    const std::optional<RecordedScan> scan = source.next();
    if (!scan) break;
    if (i % stride == 0) images.push_back(range_image(scan->cloud));
  }
  return images;
}

void measure_networks(const std::vector<std::string>& paths, const std::vector<RangeImage>& images,
                      const InterruptGuard& interrupt, Measurements& measurements) {
  for (const std::string& path : paths) {
    if (interrupt.stop_requested()) return;
    const nn::Weights weights = nn::read_weights(path, nn::all_architectures());
    if (!takes(weights, images)) {
      to_stderr("{}: left out, the network takes images of {} x {}\n", path,
                weights.description.sensor.rows(), weights.description.sensor.columns);
      continue;
    }
    if (measurements.peaks.empty()) measurements.peaks = measure_peaks(kMostThreads);
    to_stderr("network {} ...\n", nn::name(weights.description));
    measurements.networks.push_back(
        time_network(path, weights, images, measurements.peaks, kMostThreads, interrupt));
  }
}

/// The recording as SLAM is to see it: with kRowCounts of its rows, those to which they can be
/// thinned evenly, then upsampled by the networks of this sensor that are quick enough to stand
/// before SLAM.
std::vector<pipeline::UpsamplingOptions> slam_inputs(const SensorModel& sensor,
                                                     const std::vector<std::string>& paths) {
  constexpr std::int64_t kMostMultiplyAdds = 5'000'000'000;
  std::vector<pipeline::UpsamplingOptions> inputs;
  for (const int rows : kRowCounts) {
    if (sensor.rows() % rows == 0) {
      inputs.push_back({.rows = rows});
    } else {
      to_stderr("slam, {} rows: left out, they do not divide the sensor's {}\n", rows,
                sensor.rows());
    }
  }
  for (const std::string& path : paths) {
    const nn::SuperResolver network =
        nn::SuperResolver::load(path, {.architectures = nn::all_architectures()});
    if (network.multiply_adds() < kMostMultiplyAdds && network.sensor().rows() == sensor.rows() &&
        network.sensor().columns == sensor.columns) {
      inputs.push_back({.method = path});
    }
  }
  return inputs;
}

void measure_slam(const InputChoice& recording, const pipeline::UpsamplingOptions& upsampling,
                  int threads, const InterruptGuard& interrupt, Measurements& measurements) {
  if (interrupt.stop_requested()) return;
  auto input = pipeline::open_upsampled(recording.input, open_options(recording), upsampling);
  const nn::Upsampler* method = input.upsampler.method();
  to_stderr("slam, {} rows{}, {} thread{} ...\n", input.upsampler.measured_sensor().rows(),
            method != nullptr ? fmt::format(" upsampled by {}", method->name()) : "", threads,
            threads > 1 ? "s" : "");
  measurements.slam.push_back(time_slam(std::move(input), threads, interrupt));
}

Measurements measure(const InputChoice& input, const SensorModel& sensor,
                     const std::vector<std::string>& weights, const InterruptGuard& interrupt) {
  Measurements measurements;
  measurements.sensor = sensor.name;
  const std::vector<pipeline::UpsamplingOptions> inputs = slam_inputs(sensor, weights);
  for (int threads = 1; threads <= kMostThreads; ++threads) {
    for (const pipeline::UpsamplingOptions& upsampling : inputs) {
      measure_slam(input, upsampling, threads, interrupt, measurements);
    }
  }
  auto source = recordings::Recording::open(input.input, open_options(input));
  const std::vector<RangeImage> images = sample_images(source, scans_in(input, source));
  to_stderr("components and projection on {} scans ...\n", images.size());
  measurements.step_images = static_cast<int>(images.size());
  measurements.steps = time_steps(images, sensor);
  measure_networks(weights, images, interrupt, measurements);
  return measurements;
}

void print_json(const Measurements& measurements) {
  Json slam = Json::array();
  for (const SlamTiming& timing : measurements.slam) {
    Json stages;
    for (const auto& [stage, distribution] : timing.stages_ms) stages[stage] = distribution;
    slam.push_back(
        {{"rows", timing.rows},
         {"upsampled_by", timing.upsampled_by},
         {"threads", timing.threads},
         {"scans", timing.scans},
         {"upsampling_ms", timing.upsampling_ms ? Json(*timing.upsampling_ms) : Json()},
         {"stages_ms", std::move(stages)},
         {"first_fifth_ms", timing.first_fifth_ms},
         {"last_fifth_ms", timing.last_fifth_ms},
         {"peak_memory_mb", timing.peak_memory_mb ? Json(*timing.peak_memory_mb) : Json()}});
  }
  const StepTiming& steps = measurements.steps;
  const Json json = {
      {"input", measurements.input},
      {"sensor", measurements.sensor},
      {"cores", omp_get_num_procs()},
      {"slam", std::move(slam)},
      {"steps_ms",
       {{"scans", measurements.step_images},
        {"components", steps.components_ms},
        {"projection", steps.projection_ms},
        {"unprojection", steps.unprojection_ms}}},
      {"peaks", measurements.peaks},
      {"networks", measurements.networks},
  };
  to_stdout("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
}

/// "64", or "16, du-mix, memory".
std::string rows_text(const SlamTiming& timing) {
  return timing.upsampled_by.empty() ? fmt::format("{}", timing.rows)
                                     : fmt::format("{}, {}", timing.rows, timing.upsampled_by);
}

void print_slam_tables(const std::vector<SlamTiming>& timings) {
  using T = SlamTiming;
  const auto median_of = [](std::size_t stage) {
    return [stage](const T& t) { return t.stages_ms[stage].second.median; };
  };
  const auto total_of = [](const T& t) { return t.stages_ms.back().second; };
  const std::vector<Figure<T>> stages = {
      {"threads", nullptr, 0, 1.0, &T::threads},
      {"upsampling", nullptr, 2, 1.0,
       [](const T& t) {
         return t.upsampling_ms ? std::optional(t.upsampling_ms->median) : std::nullopt;
       }},
      {"segmentation", nullptr, 2, 1.0, median_of(0)},
      {"features", nullptr, 2, 1.0, median_of(1)},
      {"odometry", nullptr, 2, 1.0, median_of(2)},
      {"mapping", nullptr, 2, 1.0, median_of(3)}};
  const std::vector<Figure<T>> totals = {
      {"threads", nullptr, 0, 1.0, &T::threads},
      {"scans", nullptr, 0, 1.0, &T::scans},
      {"median", nullptr, 2, 1.0, [=](const T& t) { return total_of(t).median; }},
      {"95 %", nullptr, 2, 1.0, [=](const T& t) { return total_of(t).p95; }},
      {"scans/s", nullptr, 1, 1.0, [=](const T& t) { return 1e3 / total_of(t).mean; }},
      {"first fifth", nullptr, 1, 1.0, &T::first_fifth_ms},
      {"last fifth", nullptr, 1, 1.0, &T::last_fifth_ms},
      {"memory", nullptr, 0, 1.0, &T::peak_memory_mb}};
  to_stdout("SLAM's stages, median ms per scan\n\n{}\n",
            printed_table(table_of(timings, "Rows", stages, rows_text)));
  to_stdout("Upsampling and SLAM together, ms per scan\n\n{}\n{}\n",
            printed_table(table_of(timings, "Rows", totals, rows_text)),
            printed_definitions(
                {{"Rows", "measured rows, and the method that upsamples them"},
                 {"upsampling", "from measured points to points of all rows, with its memory"},
                 {"scans/s", "from the mean time"},
                 {"first fifth", "median of the first fifth of the scans, without the first ten"},
                 {"memory", "peak of the process's resident memory, MB"}}));
}

void print_text(const Measurements& measurements) {
  to_stdout("{}, sensor {}, {} cores\n\n", measurements.input, measurements.sensor,
            omp_get_num_procs());
  print_slam_tables(measurements.slam);
  const StepTiming& steps = measurements.steps;
  to_stdout("Single steps on {} scans, one thread, median ms per scan\n", measurements.step_images);
  to_stdout("{:<40}{:>8.2f}\n", "connected components (10 degrees)", steps.components_ms.median);
  to_stdout("{:<40}{:>8.2f}\n", "projection (scan to range image)", steps.projection_ms.median);
  to_stdout("{:<40}{:>8.2f}\n", "unprojection (range image to points)",
            steps.unprojection_ms.median);
  print_networks(measurements.peaks, measurements.networks);
}

}  // namespace

void declare(CLI::App& app, BenchOptions& options) {
  Command command = add_command(
      app, "bench", "Measure the times of SLAM's stages and of networks, with one thread and two");
  command
      .option("--input", &options.recording.input,
              "Recording to measure on, as for hqslam run (default: a simulated drive)",
              {.given = Given::kFileOrFolder})
      .option("--sensor", &options.recording.sensor,
              "Sensor of a recording that has no sensor.json (name or .json file)",
              {.needs = {"--input"}});
  declare_reading(command, options.recording);
  command
      .option("--drive", &options.drive, "Simulated drive to measure on",
              {.shows_default = true, .one_of = sim::drive_preset_names(), .excludes = {"--input"}})
      .option("--scans", &options.scans, "Length of the simulated drive",
              {.shows_default = true, .within = kAnyCount, .excludes = {"--input"}})
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
  std::optional<RemovedAtEnd> drive;
  InputChoice input = options.recording;
  if (input.input.empty()) {
    drive.emplace(temporary_folder());
    SimulateOptions simulate;
    simulate.drive = options.drive;
    simulate.sensor = "os1-64";
    simulate.scans = options.scans;
    simulate.out = drive->path.string();
    simulate_drive(simulate, interrupt);
    input.input = simulate.out;
  }
  const SensorModel sensor = recordings::Recording::open(input.input, open_options(input)).sensor();
  Measurements measurements = measure(input, sensor, weights, interrupt);
  measurements.input =
      drive ? fmt::format("simulated {}, {} scans", options.drive, options.scans) : input.input;
  if (interrupt.stop_requested()) {
    to_stderr("hqslam-lab: interrupted\n");
    return kInterrupted;
  }
  if (options.json) {
    print_json(measurements);
  } else {
    print_text(measurements);
  }
  return kOk;
}

}  // namespace hqslam::tools
