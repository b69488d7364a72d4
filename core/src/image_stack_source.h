#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hqslam/core/scan_source.h"

namespace hqslam {

/// The images of an .npy stack. Image i is of stamps_s[i]; without any stamps, of i scan periods.
/// Throws Error if their shape is not that of the sensor or if more than the last one has no stamp.
std::unique_ptr<ScanSource> make_image_stack_source(const std::string& path,
                                                    const SensorModel& sensor,
                                                    const RecordingOptions& options,
                                                    std::vector<double> stamps_s = {});

}  // namespace hqslam
