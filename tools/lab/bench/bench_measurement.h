#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/evaluation/trajectory_error.h"
#include "hqslam/nn/weights_file.h"
#include "hqslam/pipeline/upsampled_recording.h"
#include "terminal/terminal.h"
#include "timing/timing.h"

namespace hqslam::tools {

/// Times of SLAM over a drive with some of the sensor's rows and a number of threads. Only
/// upsampling and SLAM are timed.
struct SlamTiming {
  int rows;                  ///< measured
  std::string upsampled_by;  ///< method of upsampling to all rows; empty: none
  int threads;
  std::size_t scans;
  /// Of SLAM's stages, of "upsampling" where there is any (a scan of points in and out, with its
  /// memory), and of their "total".
  std::map<std::string, Statistics> times_ms;
};
SlamTiming time_slam(pipeline::UpsampledRecording input, int threads,
                     const InterruptGuard& interrupt);

/// Times of a whole network, filter included, on many scans.
struct NetworkRun {
  std::string_view instruction_set;
  int threads;
  std::size_t frames;
  Statistics frame_ms;
};
struct NetworkTiming {
  std::string network;  ///< its name
  std::int64_t parameters;
  std::int64_t multiply_adds;  ///< a frame
  std::vector<NetworkRun> runs;
};

/// Whether the images have the shape that the network takes.
bool takes(const nn::Weights& weights, const std::vector<RangeImage>& images);

/// images: all rows of a sensor of the network's shape.
NetworkTiming time_network(const nn::Weights& weights, const std::vector<RangeImage>& images,
                           int most_threads, const InterruptGuard& interrupt);

// Both as tables for a terminal.
std::string slam_text(const std::vector<SlamTiming>& timings);
std::string network_text(const NetworkTiming& timing);

}  // namespace hqslam::tools
