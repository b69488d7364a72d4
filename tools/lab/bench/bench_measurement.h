#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/pipeline/upsampled_recording.h"
#include "terminal/terminal.h"
#include "timing/timing.h"

namespace hqslam::tools {

/// Times of SLAM over a drive with some of the sensor's rows and a number of threads.
struct SlamTiming {
  int rows = 0;              ///< measured
  std::string upsampled_by;  ///< method of upsampling to all rows; empty: none
  int threads = 0;
  std::int64_t scans = 0;
  std::optional<Distribution> upsampling_ms;  ///< a scan of points in and out, with its memory
  std::vector<std::pair<std::string, Distribution>> stages_ms;  ///< and "total", with upsampling
  double first_fifth_ms = 0.0;  ///< median total of the first fifth of the scans, first 10 left out
  double last_fifth_ms = 0.0;
  std::optional<double> peak_memory_mb;  ///< resident memory of the process during this run
};

/// Only upsampling and SLAM are timed.
SlamTiming time_slam(pipeline::UpsampledRecording input, int threads,
                     const InterruptGuard& interrupt);

/// Times of single steps on some scans of the drive, one thread, per scan.
struct StepTiming {
  Distribution components_ms;    ///< ComponentLabeler, 10 degrees
  Distribution projection_ms;    ///< scan to range image
  Distribution unprojection_ms;  ///< range image to points
};
StepTiming time_steps(const std::vector<RangeImage>& images, const SensorModel& sensor);

}  // namespace hqslam::tools
