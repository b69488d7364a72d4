#pragma once

#include <nlohmann/json.hpp>

#include "hqslam/pipeline/upsampled_recording.h"
#include "terminal/terminal.h"
#include "timing/timing.h"

namespace hqslam::tools {

/// {median, p95, max, mean}
nlohmann::ordered_json distribution_json(const Distribution& distribution);

/// Times of SLAM over a drive with some of the sensor's rows and a number of threads. Only
/// upsampling and SLAM are timed.
///   {rows: measured, upsampled_by: method of upsampling to all rows, "" none, threads, scans,
///    upsampling_ms: distribution_json, a scan of points in and out, with its memory; or null,
///    stages_ms: {stage: distribution_json} and "total", with upsampling}
nlohmann::ordered_json time_slam(pipeline::UpsampledRecording input, int threads,
                                 const InterruptGuard& interrupt);

}  // namespace hqslam::tools
