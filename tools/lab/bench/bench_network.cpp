#include "bench/bench_network.h"

#include <functional>

#include "bench/bench_measurement.h"
#include "hqslam/nn/instruction_set.h"
#include "hqslam/nn/network.h"
#include "hqslam/nn/super_resolver.h"

namespace hqslam::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kRunTime_s = 1.0;  ///< of a network with one instruction set and thread count
constexpr int kFewestFrames = 3;    ///< however long they take
constexpr int kMostFrames = 300;
constexpr double kStepTime_s = 0.1;

std::vector<RangeImage> measured_rows_of(const nn::Weights& weights,
                                         const std::vector<RangeImage>& images) {
  std::vector<RangeImage> measured;
  for (const RangeImage& image : images) {
    measured.push_back(select_rows(image, weights.description.measured_rows));
  }
  return measured;
}

/// The peak of a run's instruction set and number of threads; 0 where none was measured.
double peak_of(const Json& peaks, const Json& run) {
  for (const Json& peak : peaks) {
    if (peak["instruction_set"] == run["instruction_set"] && peak["threads"] == run["threads"]) {
      return peak["gflops"];
    }
  }
  return 0.0;
}

Json time_run(const nn::Weights& weights, const std::vector<RangeImage>& measured,
              nn::InstructionSet instruction_set, int threads, const Json& peaks,
              const InterruptGuard& interrupt) {
  nn::SuperResolverOptions options;
  options.threads = threads;
  options.instruction_set = instruction_set;
  nn::SuperResolver resolver(weights, options);
  resolver.run(measured.front());
  std::vector<double> times_ms;
  const auto start = SteadyClock::now();
  for (int i = 0; i < kMostFrames && !interrupt.stop_requested(); ++i) {
    if (i >= kFewestFrames && seconds_since(start) > kRunTime_s) break;
    times_ms.push_back(1e3 * seconds_of([&] { resolver.run(measured[i % measured.size()]); }));
  }
  const Distribution frame_ms = distribution_of(times_ms);
  const double per_second = frame_ms.median > 0.0 ? 1e3 / frame_ms.median : 0.0;
  const double gflops = 2e-9 * static_cast<double>(resolver.multiply_adds()) * per_second;
  Json run = {{"instruction_set", nn::name(instruction_set)},
              {"threads", threads},
              {"frames", times_ms.size()},
              {"frames_per_second", per_second},
              {"frame_ms", distribution_json(frame_ms)},
              {"gflops", gflops}};
  const double peak = peak_of(peaks, run);
  run["peak_share"] = peak > 0.0 ? gflops / peak : 0.0;
  return run;
}

/// The median time of a step that all threads of a team share. It is called several times in one
/// parallel region, as the network calls its steps one after the other in one.
double median_ms(int threads, const std::function<void()>& step) {
  constexpr int kCalls = 4;
  std::vector<double> times_ms;
  const auto start = SteadyClock::now();
  while (times_ms.size() < 5 || seconds_since(start) < kStepTime_s) {
    const auto region_start = SteadyClock::now();
#pragma omp parallel num_threads(threads)
    for (int call = 0; call < kCalls; ++call) step();
    times_ms.push_back(1e3 * seconds_since(region_start) / kCalls);
    if (times_ms.size() >= 3 && seconds_since(start) > 5.0) break;
  }
  return distribution_of(std::move(times_ms)).median;
}

std::unique_ptr<nn::Network> network_of(const nn::Weights& weights,
                                        nn::InstructionSet instruction_set, int threads) {
  auto network = nn::make_network(weights.description, weights.description.sensor.columns,
                                  instruction_set, threads);
  network->set_parameters(weights.parameters);
  return network;
}

Json time_steps(const nn::Weights& weights, const RangeImage& measured,
                nn::InstructionSet instruction_set, int threads) {
  const auto network = network_of(weights, instruction_set, threads);
  Json steps = Json::array();
  for (const nn::NetworkStep& step : network->steps(measured)) {
    steps.push_back({{"name", step.name},
                     {"gmac", 1e-9 * step.calls * static_cast<double>(step.multiply_adds)},
                     {"ms", step.calls * median_ms(step.by_team ? threads : 1, step.run)}});
  }
  return {{"threads", threads}, {"steps", std::move(steps)}};
}

/// Times of the first step that has a reference; null if none has.
Json time_reference(const nn::Weights& weights, const RangeImage& measured,
                    nn::InstructionSet instruction_set) {
  const auto network = network_of(weights, instruction_set, 1);
  for (const nn::NetworkStep& step : network->steps(measured)) {
    if (!step.reference) continue;
    return {{"layer", step.name},
            {"fast_ms", median_ms(1, step.run)},
            {"reference_ms", median_ms(1, step.reference)}};
  }
  return {};
}

}  // namespace

Json measure_peaks(int most_threads) {
  Json peaks = Json::array();
  for (const nn::InstructionSet set : nn::available_instruction_sets()) {
    for (int threads = 1; threads <= most_threads; ++threads) {
      peaks.push_back({{"instruction_set", nn::name(set)},
                       {"threads", threads},
                       {"gflops", nn::multiply_add_peak_gflops(set, threads)}});
    }
  }
  return peaks;
}

bool takes(const nn::Weights& weights, const std::vector<RangeImage>& images) {
  const SensorModel& sensor = weights.description.sensor;
  return !images.empty() && images.front().rows == sensor.rows() &&
         images.front().columns == sensor.columns;
}

Json time_network(const std::string& path, const nn::Weights& weights,
                  const std::vector<RangeImage>& images, const Json& peaks, int most_threads,
                  const InterruptGuard& interrupt) {
  const std::vector<RangeImage> measured = measured_rows_of(weights, images);
  const nn::SuperResolver resolver(weights, {});
  Json runs = Json::array();
  for (const nn::InstructionSet set : nn::available_instruction_sets()) {
    for (int threads = 1; threads <= most_threads && !interrupt.stop_requested(); ++threads) {
      runs.push_back(time_run(weights, measured, set, threads, peaks, interrupt));
    }
  }
  const nn::InstructionSet chosen = nn::chosen_instruction_set();
  Json steps = Json::array();
  for (int threads = 1; threads <= most_threads && !interrupt.stop_requested(); ++threads) {
    steps.push_back(time_steps(weights, measured.front(), chosen, threads));
  }
  Json timing = {{"network", nn::name(weights.description)},
                 {"weights", path},
                 {"parameters", resolver.parameters()},
                 {"gmac", 1e-9 * static_cast<double>(resolver.multiply_adds())},
                 {"runs", std::move(runs)},
                 {"steps_instruction_set", nn::name(chosen)},
                 {"steps", std::move(steps)}};
  Json reference = time_reference(weights, measured.front(), chosen);
  if (!reference.is_null()) timing["reference"] = std::move(reference);
  return timing;
}

}  // namespace hqslam::tools
