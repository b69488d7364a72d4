#include "bench/bench_measurement.h"

#include <fmt/format.h>
#include <omp.h>

#include <functional>
#include <optional>
#include <utility>

#include "hqslam/nn/instruction_set.h"
#include "hqslam/nn/super_resolver.h"
#include "pages/text_table.h"
#include "run/slam_session.h"

namespace hqslam::tools {
namespace {

constexpr double kRunTime_s = 1.0;  ///< of a network with one instruction set and thread count
constexpr int kFewestFrames = 3;    ///< however long they take
constexpr int kMostFrames = 300;

std::vector<RangeImage> measured_rows_of(const nn::Weights& weights,
                                         const std::vector<RangeImage>& images) {
  std::vector<RangeImage> measured;
  for (const RangeImage& image : images) {
    measured.push_back(select_rows(image, weights.description.measured_rows));
  }
  return measured;
}

NetworkRun time_run(const nn::Weights& weights, const std::vector<RangeImage>& measured,
                    nn::InstructionSet instruction_set, int threads,
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
  return {nn::name(instruction_set), threads, times_ms.size(), statistics_of(times_ms)};
}

double frames_per_second(const NetworkRun& run) {
  return run.frame_ms.median > 0.0 ? 1e3 / run.frame_ms.median : 0.0;
}

/// A value of the times of a stage; nothing where they lack it.
Figure<SlamTiming> stage_figure(const char* title, const char* stage,
                                double Statistics::*value = &Statistics::median) {
  const auto of = [stage, value](const SlamTiming& timing) -> std::optional<double> {
    const auto found = timing.times_ms.find(stage);
    if (found == timing.times_ms.end()) return std::nullopt;
    return found->second.*value;
  };
  return {title, nullptr, 2, 1.0, of};
}

/// A figure that every row has.
template <typename Row>
Figure<Row> figure(const char* title, int decimals, const std::function<double(const Row&)>& of) {
  return {title, nullptr, decimals, 1.0, of};
}

/// "64", or "16, du-mix, memory".
std::string rows_text(const SlamTiming& timing) {
  const std::string& by = timing.upsampled_by;
  return fmt::format("{}{}{}", timing.rows, by.empty() ? "" : ", ", by);
}

}  // namespace

SlamTiming time_slam(pipeline::UpsampledRecording input, int threads,
                     const InterruptGuard& interrupt) {
  omp_set_num_threads(threads);
  SlamSession session(std::move(input.upsampler), {}, input.path, false);
  const pipeline::Upsampler& upsampler = session.pipeline().upsampler();
  while (!interrupt.stop_requested()) {
    const std::optional<RecordedScan> scan = input.recording.next();
    if (!scan) break;
    session.process(*scan);
  }
  const SlamRun& run = session.run();
  std::map<std::string, Statistics> times_ms;
  for (const ScanTimes& stage : stage_times(run)) {
    if (stage.name != "reading") times_ms[stage.name] = statistics_of(stage.times_ms);
  }
  const std::vector<double> total_ms = scan_times(run, "total", [](const ScanRecord& scan) {
                                         return scan.upsampling_s + scan.report.times.total_s;
                                       }).times_ms;
  times_ms["total"] = statistics_of(total_ms);
  return {upsampler.measured_sensor().rows(),
          run.upsampled_by + (upsampler.has_scan_memory() ? ", memory" : ""), threads,
          run.scans.size(), std::move(times_ms)};
}

bool takes(const nn::Weights& weights, const std::vector<RangeImage>& images) {
  const SensorModel& sensor = weights.description.sensor;
  return !images.empty() && images.front().rows == sensor.rows() &&
         images.front().columns == sensor.columns;
}

NetworkTiming time_network(const nn::Weights& weights, const std::vector<RangeImage>& images,
                           int most_threads, const InterruptGuard& interrupt) {
  const std::vector<RangeImage> measured = measured_rows_of(weights, images);
  const nn::SuperResolver resolver(weights, {});
  NetworkTiming timing{std::string(nn::name(weights.description)),
                       resolver.parameters(),
                       resolver.multiply_adds(),
                       {}};
  for (const nn::InstructionSet set : nn::available_instruction_sets()) {
    for (int threads = 1; threads <= most_threads && !interrupt.stop_requested(); ++threads) {
      timing.runs.push_back(time_run(weights, measured, set, threads, interrupt));
    }
  }
  return timing;
}

std::string slam_text(const std::vector<SlamTiming>& timings) {
  const auto threads =
      figure<SlamTiming>("threads", 0, [](const SlamTiming& row) { return row.threads; });
  const std::vector<Figure<SlamTiming>> stages = {threads,
                                                  stage_figure("upsampling", "upsampling"),
                                                  stage_figure("segmentation", "segmentation"),
                                                  stage_figure("features", "features"),
                                                  stage_figure("odometry", "odometry"),
                                                  stage_figure("mapping", "mapping")};
  const std::vector<Figure<SlamTiming>> totals = {
      threads,
      figure<SlamTiming>("scans", 0,
                         [](const SlamTiming& row) { return static_cast<double>(row.scans); }),
      stage_figure("median", "total"), stage_figure("95 %", "total", &Statistics::p95),
      figure<SlamTiming>(
          "scans/s", 1, [](const SlamTiming& row) { return 1e3 / row.times_ms.at("total").mean; })};
  return "SLAM's stages, median ms per scan\n\n" +
         printed_table(table_of(timings, "Rows", stages, rows_text)) +
         "\nUpsampling and SLAM together, ms per scan\n\n" +
         printed_table(table_of(timings, "Rows", totals, rows_text)) + "\n" +
         printed_definitions(
             {{"Rows", "measured rows, and the method that upsamples them"},
              {"upsampling", "from measured points to points of all rows, with its memory"},
              {"scans/s", "from the mean time"}}) +
         "\n";
}

std::string network_text(const NetworkTiming& timing) {
  const double gmac = 1e-9 * static_cast<double>(timing.multiply_adds);
  const std::vector<Figure<NetworkRun>> figures = {
      figure<NetworkRun>("threads", 0, [](const NetworkRun& run) { return run.threads; }),
      figure<NetworkRun>("frames", 0,
                         [](const NetworkRun& run) { return static_cast<double>(run.frames); }),
      figure<NetworkRun>("frames/s", 1, frames_per_second),
      figure<NetworkRun>("ms/frame", 2, [](const NetworkRun& run) { return run.frame_ms.median; }),
      figure<NetworkRun>("95 %", 2, [](const NetworkRun& run) { return run.frame_ms.p95; }),
      figure<NetworkRun>("GFLOP/s", 1, [&](const NetworkRun& run) {
        return 2.0 * gmac * frames_per_second(run);
      })};
  const auto name = [](const NetworkRun& run) { return std::string(run.instruction_set); };
  return fmt::format("\n{}: whole network, filter included; {} parameters, {:.3f} GMAC a frame\n",
                     timing.network, timing.parameters, gmac) +
         printed_table(table_of(timing.runs, "instructions", figures, name));
}

}  // namespace hqslam::tools
