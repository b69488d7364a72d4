#include "bench/bench_network.h"

#include <functional>

#include "hqslam/nn/network.h"
#include "hqslam/nn/super_resolver.h"

namespace hqslam::tools {
namespace {

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

double peak_of(const std::vector<MultiplyAddPeak>& peaks, nn::InstructionSet instruction_set,
               int threads) {
  for (const MultiplyAddPeak& peak : peaks) {
    if (peak.instruction_set == instruction_set && peak.threads == threads) return peak.gflops;
  }
  return 0.0;
}

NetworkRun time_run(const nn::Weights& weights, const std::vector<RangeImage>& measured,
                    nn::InstructionSet instruction_set, int threads,
                    const std::vector<MultiplyAddPeak>& peaks, const InterruptGuard& interrupt) {
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
  NetworkRun run;
  run.instruction_set = instruction_set;
  run.threads = threads;
  run.frames = static_cast<int>(times_ms.size());
  run.frame_ms = distribution_of(std::move(times_ms));
  const double peak = peak_of(peaks, instruction_set, threads);
  run.gflops = run.frame_ms.median > 0.0
                   ? 2e-6 * static_cast<double>(resolver.multiply_adds()) / run.frame_ms.median
                   : 0.0;
  run.peak_share = peak > 0.0 ? run.gflops / peak : 0.0;
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

NetworkSteps time_steps(const nn::Weights& weights, const RangeImage& measured,
                        nn::InstructionSet instruction_set, int threads) {
  const auto network = nn::make_network(weights.description, weights.description.sensor.columns,
                                        instruction_set, threads);
  network->set_parameters(weights.parameters);
  NetworkSteps result;
  result.threads = threads;
  for (const nn::NetworkStep& step : network->steps(measured)) {
    result.steps.push_back({step.name, 1e-9 * step.calls * static_cast<double>(step.multiply_adds),
                            step.calls * median_ms(step.by_team ? threads : 1, step.run)});
  }
  return result;
}

/// Of the first step that is there twice; nothing if none is.
std::optional<ReferenceRatio> time_reference(const nn::Weights& weights, const RangeImage& measured,
                                             nn::InstructionSet instruction_set) {
  const auto network =
      nn::make_network(weights.description, weights.description.sensor.columns, instruction_set, 1);
  network->set_parameters(weights.parameters);
  for (const nn::NetworkStep& step : network->steps(measured)) {
    if (!step.reference) continue;
    return ReferenceRatio{.layer = step.name,
                          .fast_ms = median_ms(1, step.run),
                          .reference_ms = median_ms(1, step.reference)};
  }
  return std::nullopt;
}

}  // namespace

std::vector<MultiplyAddPeak> measure_peaks(int most_threads) {
  std::vector<MultiplyAddPeak> peaks;
  for (const nn::InstructionSet set : nn::available_instruction_sets()) {
    for (int threads = 1; threads <= most_threads; ++threads) {
      peaks.push_back({set, threads, nn::multiply_add_peak_gflops(set, threads)});
    }
  }
  return peaks;
}

bool takes(const nn::Weights& weights, const std::vector<RangeImage>& images) {
  const SensorModel& sensor = weights.description.sensor;
  return !images.empty() && images.front().rows == sensor.rows() &&
         images.front().columns == sensor.columns;
}

NetworkTiming time_network(const std::string& path, const nn::Weights& weights,
                           const std::vector<RangeImage>& images,
                           const std::vector<MultiplyAddPeak>& peaks, int most_threads,
                           const InterruptGuard& interrupt) {
  const std::vector<RangeImage> measured = measured_rows_of(weights, images);
  const nn::SuperResolver resolver(weights, {});
  NetworkTiming timing;
  timing.path = path;
  timing.name = nn::name(weights.description);
  timing.parameters = resolver.parameters();
  timing.gmac = 1e-9 * static_cast<double>(resolver.multiply_adds());
  for (const nn::InstructionSet set : nn::available_instruction_sets()) {
    for (int threads = 1; threads <= most_threads && !interrupt.stop_requested(); ++threads) {
      timing.runs.push_back(time_run(weights, measured, set, threads, peaks, interrupt));
    }
  }
  timing.steps_instruction_set = nn::chosen_instruction_set();
  for (int threads = 1; threads <= most_threads && !interrupt.stop_requested(); ++threads) {
    timing.steps.push_back(
        time_steps(weights, measured.front(), timing.steps_instruction_set, threads));
  }
  timing.reference = time_reference(weights, measured.front(), timing.steps_instruction_set);
  return timing;
}

}  // namespace hqslam::tools
