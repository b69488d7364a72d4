#pragma once

#include <string>

#include "error_message.h"
#include "files/scan_files.h"
#include "hqslam/core/error.h"

namespace hqslam::test {

/// What is wrong with a recording, read to its end.
inline std::string recording_complaint(const std::string& path, const SensorModel& sensor) {
  return error_message([&] {
    const auto source = recordings::open_scan_files(path, sensor);
    while (source->next()) {
    }
  });
}

/// Whether its first nine scans are left out, and the tenth, as none was read before, ends it.
inline bool is_given_up_at_tenth(ScanSource& source) {
  for (int i = 0; i < 10; ++i) {
    try {
      source.next();
      return false;
    } catch (const ScanError&) {
      continue;
    } catch (const Error&) {
      return i == 9;
    }
  }
  return false;
}

}  // namespace hqslam::test
