#pragma once

#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/training/training_configuration.h"
#include "interrupt.h"

namespace hqslam::tools {

/// All scans of a set, in memory, in the order of the set: stacks first, then drives, which are
/// simulated. Shows progress on stderr; stops early when asked to. Throws Error, also for a stack
/// of another shape than the sensor's.
std::vector<RangeImage> load_scans(const nn::ScanSet& set, const SensorModel& sensor,
                                   const char* label, const InterruptGuard& interrupt);

}  // namespace hqslam::tools
