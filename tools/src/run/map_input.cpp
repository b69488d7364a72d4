#include "run/map_input.h"

#include <algorithm>

#include "hqslam/slam/dense_map.h"
#include "terminal/progress.h"

namespace hqslam::tools {

namespace {

LiftedInput input_of(const InputChoice& recording, const LiftingChoice& lifting, double voxel_m) {
  nn::SuperResolverOptions network;
  network.tolerance_m = static_cast<float>(voxel_m);
  network.least_confidence = slam::DenseMapOptions::kLeastPointConfidence;
  return lifted_input(recording, {lifting.upsample, lifting.rows}, network);
}

}  // namespace

MapInput::MapInput(const InputChoice& recording, const LiftingChoice& lifting, double voxel_m)
    : input_(input_of(recording, lifting, voxel_m)),
      measured_rows_(input_.upsampler ? input_.upsampler->measured_rows()
                     : input_.rows    ? std::nullopt
                                      : input_.recorded.measured_rows),
      memory_(input_.lifter()) {}

MapReading MapInput::read_all(
    const ScanPoses& poses, const std::string& label, const InterruptGuard& interrupt,
    const std::function<void(const RecordedScan&, const slam::SensorPath&)>& use) {
  const auto source = input_.open();
  const auto& scans = poses.scan_of_pose;
  std::optional<std::int64_t> most = source->size();
  if (scans && !scans->empty()) {
    most = std::min(most.value_or(scans->back() + 1), scans->back() + 1);
  }
  Progress progress(label, most);
  MapReading reading;
  read_scans(*source, interrupt, reading, [&](const ReadScan& read) {
    if (const auto path = poses.path_of(read.index, read.scan.stamp_s)) {
      use(read.scan, *path);
      ++reading.scans;
    } else {
      ++reading.without_pose;
    }
    progress.update(read.index + 1, source->read_share());
    return !most || read.index + 1 < *most;
  });
  progress.finish();
  return reading;
}

OrganizedCloud MapInput::measured(const RecordedScan& scan) const {
  const OrganizedCloud cloud = input_.measured(scan.cloud);
  return is_partly_computed() ? select_rows(cloud, *measured_rows_) : cloud;
}

SensorModel MapInput::measuring() const {
  const SensorModel sensor = input_.measuring();
  return is_partly_computed() ? select_rows(sensor, *measured_rows_) : sensor;
}

OrganizedCloud MapInput::lifted(const RecordedScan& scan, const slam::SensorPath& path) {
  const OrganizedCloud measured = input_.measured(scan.cloud);
  return input_.lifted(measured, memory_.recall_and_remember(measured, path, scan.stamp_s));
}

}  // namespace hqslam::tools
