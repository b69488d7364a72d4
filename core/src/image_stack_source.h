#pragma once

#include <memory>
#include <string>

#include "hqslam/core/scan_source.h"

namespace hqslam {

/// The images of an .npy stack. Throws Error if their shape is not that of the sensor.
std::unique_ptr<ScanSource> make_image_stack_source(const std::string& path,
                                                    const SensorModel& sensor,
                                                    const RecordingOptions& options);

}  // namespace hqslam
