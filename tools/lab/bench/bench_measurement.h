#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/nn/weights_file.h"
#include "hqslam/pipeline/upsampled_recording.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

// Times as JSON; a distribution is {median, p95, max, mean}.

/// Times of SLAM over a drive with some of the sensor's rows and a number of threads. Only
/// upsampling and SLAM are timed.
///   {rows: measured, upsampled_by: method of upsampling to all rows, "" none, threads, scans,
///    upsampling_ms: a distribution, a scan of points in and out, with its memory; or null,
///    stages_ms: {stage: a distribution} and "total", with upsampling}
nlohmann::ordered_json time_slam(pipeline::UpsampledRecording input, int threads,
                                 const InterruptGuard& interrupt);

/// Whether the images have the shape that the network takes.
bool takes(const nn::Weights& weights, const std::vector<RangeImage>& images);

/// Times of a network. images: all rows of a sensor of the network's shape.
///   {network: its name, weights: path, parameters, gmac: per frame,
///    runs: of the whole network, filter included, on many scans
///      [{instruction_set, threads, frames, frames_per_second, frame_ms: a distribution,
///        gflops: at the median}]}
nlohmann::ordered_json time_network(const std::string& path, const nn::Weights& weights,
                                    const std::vector<RangeImage>& images, int most_threads,
                                    const InterruptGuard& interrupt);

}  // namespace hqslam::tools
