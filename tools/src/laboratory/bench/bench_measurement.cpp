#include "laboratory/bench/bench_measurement.h"

#include <malloc.h>
#include <omp.h>

#include <algorithm>
#include <fstream>

#include "hqslam/core/connected_components.h"
#include "hqslam/core/projection.h"
#include "hqslam/nn/upsampled_cloud.h"
#include "hqslam/slam/slam.h"
#include "lift/drive_memory.h"

namespace hqslam::tools {
namespace {

constexpr std::size_t kWarmUpScans = 10;
constexpr double kOutlierAngle_rad = 0.17453292519943295;  // 10 degrees

template <typename Step>
double milliseconds_of(const Step& step) {
  return 1e3 * seconds_of(step);
}

Distribution stage_distribution(const std::vector<slam::StageTimes>& times,
                                double slam::StageTimes::*stage) {
  std::vector<double> values_ms;
  for (const slam::StageTimes& scan : times) values_ms.push_back(1e3 * scan.*stage);
  return distribution_of(std::move(values_ms));
}

/// Median over the scans [begin, end).
double median_ms(const std::vector<double>& values_ms, std::size_t begin, std::size_t end) {
  const auto from =
      values_ms.begin() + static_cast<std::ptrdiff_t>(std::min(begin, values_ms.size()));
  const auto to = values_ms.begin() + static_cast<std::ptrdiff_t>(std::min(end, values_ms.size()));
  return from < to ? distribution_of({from, to}).median : 0.0;
}

/// Makes the kernel count the peak of resident memory anew, so that one run is not charged with
/// another's (Linux, proc(5): clear_refs 5).
void reset_peak_memory() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5\n";
}

/// Peak resident memory since then in MB, from proc(5)'s VmHWM; nothing where there is no /proc.
std::optional<double> peak_memory_mb() {
  std::ifstream status("/proc/self/status");
  std::string field;
  while (status >> field) {
    double kibibytes = 0.0;
    if (field == "VmHWM:" && status >> kibibytes) return kibibytes * 1024.0 / 1e6;
  }
  return std::nullopt;
}

}  // namespace

SlamTiming time_slam(ScanSource& source, int rows, nn::Upsampler* upsampler, int threads,
                     const InterruptGuard& interrupt) {
  omp_set_num_threads(threads);
  reset_peak_memory();
  const RowSelection selection = upsampler != nullptr ? upsampler->measured_rows()
                                                      : selection_for(source.sensor().rows(), rows);
  slam::Slam slam(upsampler != nullptr ? upsampler->sensor()
                                       : select_rows(source.sensor(), selection));
  DriveMemory memory(upsampler);
  std::vector<slam::StageTimes> times;
  std::vector<double> upsampling_ms;
  std::vector<double> total_ms;
  while (!interrupt.stop_requested()) {
    const std::optional<RecordedScan> scan = source.next();
    if (!scan) break;
    const OrganizedCloud measured = select_rows(scan->cloud, selection);
    OrganizedCloud lifted;
    upsampling_ms.push_back(upsampler == nullptr ? 0.0 : milliseconds_of([&] {
      lifted = nn::upsampled_cloud(*upsampler, measured,
                                   memory.recall(measured, slam.trajectory(), scan->stamp_s));
    }));
    const slam::ScanReport report =
        slam.process(upsampler == nullptr ? measured : lifted, scan->stamp_s);
    times.push_back(report.times);
    upsampling_ms.back() += milliseconds_of([&] {
      memory.remember(measured, slam.trajectory(), slam::is_registered(report.mapping_status));
    });
    total_ms.push_back(upsampling_ms.back() + 1e3 * times.back().total_s);
  }
  SlamTiming timing;
  timing.rows = rows;
  timing.threads = threads;
  timing.scans = static_cast<std::int64_t>(times.size());
  if (upsampler != nullptr) {
    timing.upsampled_by = upsampler->name() + (upsampler->has_scan_memory() ? ", memory" : "");
    timing.upsampling_ms = distribution_of(std::move(upsampling_ms));
  }
  for (const Stage& stage : kStages) {
    timing.stages_ms.emplace_back(stage.name, stage_distribution(times, stage.seconds));
  }
  const std::size_t fifth = times.size() / 5;
  timing.first_fifth_ms = median_ms(total_ms, kWarmUpScans, kWarmUpScans + fifth);
  timing.last_fifth_ms = median_ms(total_ms, times.size() - fifth, times.size());
  timing.stages_ms.emplace_back("total", distribution_of(std::move(total_ms)));
  timing.peak_memory_mb = peak_memory_mb();
  return timing;
}

StepTiming time_steps(const std::vector<RangeImage>& images, const SensorModel& sensor) {
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
  return {distribution_of(std::move(components_ms)), distribution_of(std::move(textbook_ms)),
          distribution_of(std::move(projection_ms)), distribution_of(std::move(unprojection_ms))};
}

}  // namespace hqslam::tools
