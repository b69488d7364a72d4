#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hqslam/core/scan_source.h"

namespace hqslam {

/// One scan per file, all of one kind, in the order given. Throws Error.
std::unique_ptr<ScanSource> make_file_scan_source(std::vector<std::string> paths,
                                                  const SensorModel& sensor,
                                                  const RecordingOptions& options);

}  // namespace hqslam
