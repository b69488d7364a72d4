#pragma once

#include "hqslam/pipeline/upsampled_recording.h"
#include "run/run_command.h"
#include "run/run_output.h"

namespace hqslam::tools {

/// SLAM over the recording, which is read anew where that helps: with the capture of points without
/// times, with corrected beams, without large parts of the vehicle. `options` then has the capture
/// and the beams. Warnings, and why it begins anew, go to stderr. Throws Error.
SlamRun slam_over(RunOptions& options, RunOutput& output, const InterruptGuard& interrupt,
                  pipeline::UpsampledRecording input);

}  // namespace hqslam::tools
