#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hqslam/nn/training/augmentation.h"
#include "recording/recording_choice.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

/// What a recorded drive teaches about the rows between those that its sensor measures: other scans
/// measured them from elsewhere.
struct RecordedDrive {
  /// Each scan with all rows of the result. Measured rows are as they were measured; a computed
  /// pixel has minus the range at which other scans agree, or is unknown (nn/kernels/two_modes.h).
  std::vector<nn::TrainingScan> scans;
  SensorModel sensor;  ///< of the result
  RowSelection measured_rows;
};

/// Reads a recording, locates its scans by SLAM, and projects into each of them the points of those
/// around it. weights: for any sensor, or for the recording's. Throws Error; returns no scans if
/// interrupted.
RecordedDrive read_recorded_drive(const InputChoice& input, const std::string& weights,
                                  const InterruptGuard& interrupt);

}  // namespace hqslam::tools
