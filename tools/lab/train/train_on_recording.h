#pragma once

#include <cstdint>
#include <string>

#include "recording/recording_choice.h"

namespace hqslam::tools {

struct RecordingTraining {
  InputChoice recording;
  std::string start_from;  ///< weights for any sensor, or for the recording's
  std::string out;
  std::int64_t steps = 400;
  int threads = 1;
};

/// Trains weights on with a recorded drive, its last fifth held out, and writes weights.npz into
/// the folder `out`: the new ones where they come nearer to what other scans measured in the scans
/// held out, otherwise the old ones. Prints how near both come. Returns an ExitStatus. Throws
/// Error.
int train_on_recording(const RecordingTraining& training);

}  // namespace hqslam::tools
