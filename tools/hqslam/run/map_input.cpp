#include "run/map_input.h"

#include <algorithm>

#include "hqslam/slam/dense_map.h"
#include "terminal/progress.h"

namespace hqslam::tools {

namespace {

pipeline::UpsampledRecording input_of(const InputChoice& recording,
                                      const UpsamplingChoice& upsampling, double voxel_m) {
  pipeline::UpsamplingOptions options = upsampling_options(upsampling);
  options.network.tolerance_m = static_cast<float>(voxel_m);
  options.network.least_confidence = slam::DenseMapOptions::kLeastPointConfidence;
  return pipeline::open_upsampled(recording.input, open_options(recording), options);
}

}  // namespace

MapInput::MapInput(const InputChoice& recording, const UpsamplingChoice& upsampling, double voxel_m)
    : input_(input_of(recording, upsampling, voxel_m)),
      wanted_(wanted_scans(recording)),
      measured_rows_(upsampler().sensor().measured_rows) {}

MapReading MapInput::read(const ScanPoses& poses, const std::string& label,
                          const InterruptGuard& interrupt,
                          const std::function<void(const ReadScan&, const slam::SensorPath&)>& use,
                          const LookAhead& look_ahead) {
  recordings::Recording source = input_.reopened();
  const auto& scans = poses.scan_of_pose;
  std::optional<std::int64_t> most = source.size();
  if (scans && !scans->empty()) {
    most = std::min(most.value_or(scans->back() + 1), scans->back() + 1);
  }
  Progress progress(label, most);
  MapReading reading;
  reading.wanted = wanted_;
  const auto use_if_known = [&](const ReadScan& read) {
    if (const auto path =
            poses.path_of(read.index, read.scan.stamp_s, upsampler().recorded().scan_period_s)) {
      use(read, *path);
      ++reading.scans;
    } else {
      ++reading.without_pose;
    }
    progress.update(read.index + 1, source.read_share());
    return !most || read.index + 1 < *most;
  };
  read_scans(source, interrupt, reading, use_if_known, look_ahead);
  progress.finish();
  return reading;
}

MapReading MapInput::read_measured(const ScanPoses& poses, const std::string& label,
                                   const InterruptGuard& interrupt, const Use& use) {
  const auto use_measured = [&](const ReadScan& recorded, const slam::SensorPath& path) {
    const OrganizedCloud cloud = upsampler().measured(recorded.scan.cloud);
    use(is_partly_computed() ? select_rows(cloud, *measured_rows_) : cloud, path);
  };
  return read(poses, label, interrupt, use_measured, {});
}

MapReading MapInput::read_upsampled(const ScanPoses& poses, const std::string& label,
                                    const InterruptGuard& interrupt, const Use& use) {
  pipeline::LookAheadMemory memory(upsampler().method(), poses);
  const auto use_upsampled = [&](const ReadScan& read, const slam::SensorPath& path) {
    const OrganizedCloud measured = upsampler().measured(read.scan.cloud);
    use(upsampler().upsampled(measured, memory.recall(measured, read.index, read.scan.stamp_s)),
        path);
  };
  return read(poses, label, interrupt, use_upsampled, look_ahead_of(memory, upsampler()));
}

SensorModel MapInput::measuring() const {
  const SensorModel& sensor = input_.upsampler.measured_sensor();
  return is_partly_computed() ? select_rows(sensor, *measured_rows_) : sensor;
}

}  // namespace hqslam::tools
