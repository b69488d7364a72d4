#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
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

/// {median, p95, max, mean}
nlohmann::ordered_json distribution_json(const Distribution& distribution);

/// Times of SLAM over a drive with some of the sensor's rows and a number of threads. Only
/// upsampling and SLAM are timed.
///   {rows: measured, upsampled_by: method of upsampling to all rows, "" none, threads, scans,
///    upsampling_ms: distribution_json, a scan of points in and out, with its memory; or null,
///    stages_ms: {stage: distribution_json} and "total", with upsampling,
///    first_fifth_ms: median total of the first fifth of the scans, first 10 left out,
///    last_fifth_ms, peak_memory_mb: resident memory of the process during this run, or null}
nlohmann::ordered_json time_slam(pipeline::UpsampledRecording input, int threads,
                                 const InterruptGuard& interrupt);

/// Times of single steps on some scans of the drive, one thread, per scan.
///   {scans, and of each a distribution_json: components: ComponentLabeler, 10 degrees,
///    components_textbook: textbook_components on the same images, projection: scan to range image,
///    unprojection: range image to points}
nlohmann::ordered_json time_steps(const std::vector<RangeImage>& images, const SensorModel& sensor);

}  // namespace hqslam::tools
