#pragma once

#include "files/scan_files.h"

namespace hqslam::test {

/// Files of scans of `sensor`, which is not held against their points.
inline std::unique_ptr<ScanSource> open_scan_files(
    const std::string& path, const SensorModel& sensor,
    const recordings::RecordingOptions& options = {}) {
  const auto choose = [&](const std::function<recordings::FoundSensor()>&) {
    return recordings::FoundSensor{sensor, {}, "", false};
  };
  return recordings::open_scan_files(path, sensor, choose, options);
}

}  // namespace hqslam::test
