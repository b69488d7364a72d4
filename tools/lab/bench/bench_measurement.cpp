#include "bench/bench_measurement.h"

#include <omp.h>

#include "run/slam_session.h"

namespace hqslam::tools {

using Json = nlohmann::ordered_json;

Json distribution_json(const Distribution& distribution) {
  return {{"median", distribution.median},
          {"p95", distribution.p95},
          {"max", distribution.max},
          {"mean", distribution.mean}};
}

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
        distribution_json(distribution_of(stage.times_ms));
  }
  const std::vector<double> total_ms = scan_times(run, "total", [](const ScanRecord& scan) {
                                         return scan.upsampling_s + scan.report.times.total_s;
                                       }).times_ms;
  stages_ms["total"] = distribution_json(distribution_of(total_ms));
  return {{"rows", upsampler.measured_sensor().rows()},
          {"upsampled_by", run.upsampled_by + (upsampler.has_scan_memory() ? ", memory" : "")},
          {"threads", threads},
          {"scans", run.scans.size()},
          {"upsampling_ms", std::move(upsampling_ms)},
          {"stages_ms", std::move(stages_ms)}};
}

}  // namespace hqslam::tools
