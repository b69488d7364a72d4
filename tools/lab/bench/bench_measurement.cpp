#include "bench/bench_measurement.h"

#include <malloc.h>
#include <omp.h>

#include <algorithm>
#include <fstream>

#include "hqslam/core/connected_components.h"
#include "hqslam/core/projection.h"
#include "run/slam_session.h"

namespace hqslam::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kWarmUpScans = 10;
constexpr double kOutlierAngle_rad = 0.17453292519943295;  // 10 degrees

template <typename Step>
double milliseconds_of(const Step& step) {
  return 1e3 * seconds_of(step);
}

/// Median over the scans [begin, end).
double median_ms(const std::vector<double>& values_ms, std::size_t begin, std::size_t end) {
  const auto from =
      values_ms.begin() + static_cast<std::ptrdiff_t>(std::min(begin, values_ms.size()));
  const auto to = values_ms.begin() + static_cast<std::ptrdiff_t>(std::min(end, values_ms.size()));
  return from < to ? distribution_of({from, to}).median : 0.0;
}

/// Resets the kernel's peak of resident memory, so that it is that of one run (Linux, proc(5):
/// clear_refs 5).
void reset_peak_memory() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5\n";
}

/// Peak resident memory since the last reset in MB, from proc(5)'s VmHWM; null without /proc.
Json peak_memory_mb() {
  std::ifstream status("/proc/self/status");
  std::string field;
  while (status >> field) {
    double kibibytes = 0.0;
    if (field == "VmHWM:" && status >> kibibytes) return kibibytes * 1024.0 / 1e6;
  }
  return {};
}

}  // namespace

Json distribution_json(const Distribution& distribution) {
  return {{"median", distribution.median},
          {"p95", distribution.p95},
          {"max", distribution.max},
          {"mean", distribution.mean}};
}

Json time_slam(pipeline::UpsampledRecording input, int threads, const InterruptGuard& interrupt) {
  omp_set_num_threads(threads);
  reset_peak_memory();
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
        distribution_json(distribution_of(stage.times_ms));
  }
  const std::vector<double> total_ms = scan_times(run, "total", [](const ScanRecord& scan) {
                                         return scan.upsampling_s + scan.report.times.total_s;
                                       }).times_ms;
  stages_ms["total"] = distribution_json(distribution_of(total_ms));
  const std::size_t fifth = total_ms.size() / 5;
  return {{"rows", upsampler.measured_sensor().rows()},
          {"upsampled_by", run.upsampled_by + (upsampler.has_scan_memory() ? ", memory" : "")},
          {"threads", threads},
          {"scans", run.scans.size()},
          {"upsampling_ms", std::move(upsampling_ms)},
          {"stages_ms", std::move(stages_ms)},
          {"first_fifth_ms", median_ms(total_ms, kWarmUpScans, kWarmUpScans + fifth)},
          {"last_fifth_ms", median_ms(total_ms, total_ms.size() - fifth, total_ms.size())},
          {"peak_memory_mb", peak_memory_mb()}};
}

Json time_steps(const std::vector<RangeImage>& images, const SensorModel& sensor) {
  constexpr int kRepetitions = 5;
  omp_set_num_threads(1);
  ConnectedComponentsOptions options;
  options.min_angle_rad = kOutlierAngle_rad;
  ComponentLabeler labeler(sensor, options);
  std::vector<double> components_ms;
  std::vector<double> textbook_ms;
  std::vector<double> projection_ms;
  std::vector<double> unprojection_ms;
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    for (const RangeImage& image : images) {
      components_ms.push_back(milliseconds_of([&] { labeler.label(image); }));
      textbook_ms.push_back(
          milliseconds_of([&] { textbook_components(image, sensor, kOutlierAngle_rad); }));
      OrganizedCloud cloud;
      unprojection_ms.push_back(milliseconds_of(
          [&] { cloud = unproject(image, sensor, CaptureTime::kMotionCorrected); }));
      const Scan scan = returns_of(cloud);
      projection_ms.push_back(milliseconds_of([&] { project(scan, sensor); }));
    }
  }
  return {{"scans", images.size()},
          {"components", distribution_json(distribution_of(std::move(components_ms)))},
          {"components_textbook", distribution_json(distribution_of(std::move(textbook_ms)))},
          {"projection", distribution_json(distribution_of(std::move(projection_ms)))},
          {"unprojection", distribution_json(distribution_of(std::move(unprojection_ms)))}};
}

}  // namespace hqslam::tools
