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

/// Connected components as a textbook has them, the baseline for ComponentLabeler: breadth first
/// with std::queue, memory of its own on each call and atan2 for each pair of pixels. Neighbours,
/// angle criterion and column wrap are ComponentLabeler's. Returns the label of each pixel, -1
/// where there is no return.
///
/// The angle between the longer beam and the line through both points (Bogoslavskyi & Stachniss,
/// IROS 2016): atan2(d2 sin(alpha), d1 - d2 cos(alpha)) with d1 >= d2 and alpha between the beams.
std::vector<std::int32_t> textbook_components(const RangeImage& image, const SensorModel& sensor,
                                              double min_angle_rad);

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
  Distribution components_ms;           ///< ComponentLabeler, 10 degrees
  Distribution components_textbook_ms;  ///< textbook_components on the same images
  Distribution projection_ms;           ///< scan to range image
  Distribution unprojection_ms;         ///< range image to points
};
StepTiming time_steps(const std::vector<RangeImage>& images, const SensorModel& sensor);

}  // namespace hqslam::tools
