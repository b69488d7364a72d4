#pragma once

#include "error_message.h"
#include "opened_files.h"

namespace hqslam::test {

/// Whether a recording, read to its end, is refused in one line with these parts.
bool recording_refused(const std::string& path, const SensorModel& sensor, const auto&... parts) {
  const auto read = [&] {
    const auto source = open_scan_files(path, sensor);
    while (source->next()) continue;
  };
  return refused_with(read, parts...);
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
