#include "bench/bench_measurement.h"

#include <omp.h>

#include "hqslam/evaluation/trajectory_error.h"
#include "hqslam/nn/instruction_set.h"
#include "hqslam/nn/super_resolver.h"
#include "run/slam_session.h"
#include "timing/timing.h"

namespace hqslam::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kRunTime_s = 1.0;  ///< of a network with one instruction set and thread count
constexpr int kFewestFrames = 3;    ///< however long they take
constexpr int kMostFrames = 300;

Json distribution_json(const Statistics& distribution) {
  return {{"median", distribution.median},
          {"p95", distribution.p95},
          {"max", distribution.max},
          {"mean", distribution.mean}};
}

std::vector<RangeImage> measured_rows_of(const nn::Weights& weights,
                                         const std::vector<RangeImage>& images) {
  std::vector<RangeImage> measured;
  for (const RangeImage& image : images) {
    measured.push_back(select_rows(image, weights.description.measured_rows));
  }
  return measured;
}

Json time_run(const nn::Weights& weights, const std::vector<RangeImage>& measured,
              nn::InstructionSet instruction_set, int threads, const InterruptGuard& interrupt) {
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
  const Statistics frame_ms = statistics_of(times_ms);
  const double per_second = frame_ms.median > 0.0 ? 1e3 / frame_ms.median : 0.0;
  return {{"instruction_set", nn::name(instruction_set)},
          {"threads", threads},
          {"frames", times_ms.size()},
          {"frames_per_second", per_second},
          {"frame_ms", distribution_json(frame_ms)},
          {"gflops", 2e-9 * static_cast<double>(resolver.multiply_adds()) * per_second}};
}

}  // namespace

Json time_slam(pipeline::UpsampledRecording input, int threads, const InterruptGuard& interrupt) {
  omp_set_num_threads(threads);
  SlamSession session(std::move(input.upsampler), {}, input.path, false);
  const pipeline::Upsampler& upsampler = session.pipeline().upsampler();
  while (!interrupt.stop_requested()) {
    const std::optional<RecordedScan> scan = input.recording.next();
    if (!scan) break;
    session.process(*scan);
  }
  const SlamRun& run = session.run();
  Json upsampling_ms;
  Json stages_ms;
  for (const ScanTimes& stage : stage_times(run)) {
    if (stage.name == "reading") continue;
    (stage.name == "upsampling" ? upsampling_ms : stages_ms[stage.name]) =
        distribution_json(statistics_of(stage.times_ms));
  }
  const std::vector<double> total_ms = scan_times(run, "total", [](const ScanRecord& scan) {
                                         return scan.upsampling_s + scan.report.times.total_s;
                                       }).times_ms;
  stages_ms["total"] = distribution_json(statistics_of(total_ms));
  return {{"rows", upsampler.measured_sensor().rows()},
          {"upsampled_by", run.upsampled_by + (upsampler.has_scan_memory() ? ", memory" : "")},
          {"threads", threads},
          {"scans", run.scans.size()},
          {"upsampling_ms", std::move(upsampling_ms)},
          {"stages_ms", std::move(stages_ms)}};
}

bool takes(const nn::Weights& weights, const std::vector<RangeImage>& images) {
  const SensorModel& sensor = weights.description.sensor;
  return !images.empty() && images.front().rows == sensor.rows() &&
         images.front().columns == sensor.columns;
}

Json time_network(const std::string& path, const nn::Weights& weights,
                  const std::vector<RangeImage>& images, int most_threads,
                  const InterruptGuard& interrupt) {
  const std::vector<RangeImage> measured = measured_rows_of(weights, images);
  const nn::SuperResolver resolver(weights, {});
  Json runs = Json::array();
  for (const nn::InstructionSet set : nn::available_instruction_sets()) {
    for (int threads = 1; threads <= most_threads && !interrupt.stop_requested(); ++threads) {
      runs.push_back(time_run(weights, measured, set, threads, interrupt));
    }
  }
  return {{"network", nn::name(weights.description)},
          {"weights", path},
          {"parameters", resolver.parameters()},
          {"gmac", 1e-9 * static_cast<double>(resolver.multiply_adds())},
          {"runs", std::move(runs)}};
}

}  // namespace hqslam::tools
