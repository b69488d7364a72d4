#pragma once

#include <string>

#include "error_message.h"
#include "hqslam/core/scan_source.h"

namespace hqslam::test {

/// What is wrong with a recording, read to its end.
inline std::string recording_complaint(const std::string& path, const SensorModel& sensor) {
  return error_message([&] {
    const auto source = open_recording(path, sensor);
    while (source->next()) {
    }
  });
}

}  // namespace hqslam::test
