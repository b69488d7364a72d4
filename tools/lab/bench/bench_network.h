#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/nn/weights_file.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

/// The processor's peaks of multiply-adds, for every available instruction set with 1 to
/// `most_threads` threads: [{instruction_set, threads, gflops}].
nlohmann::ordered_json measure_peaks(int most_threads);

/// Whether the images have the shape that the network takes.
bool takes(const nn::Weights& weights, const std::vector<RangeImage>& images);

/// Times of a network. images: all rows of a sensor of the network's shape.
///   {network: its name, weights: path, parameters, gmac: per frame,
///    runs: of the whole network, filter included, on many scans
///      [{instruction_set, threads, frames, frames_per_second, frame_ms: distribution_json,
///        gflops: at the median, peak_share: of the peak of the same set and threads}],
///    steps_instruction_set,
///    steps: of each kind of step, measured alone; all calls for a frame together
///      [{threads, steps: [{name, gmac: 0 is not a convolution, ms: median}]}],
///    reference: where a convolution has one, its time and that of its formula; one thread
///      {layer, fast_ms, reference_ms}}
nlohmann::ordered_json time_network(const std::string& path, const nn::Weights& weights,
                                    const std::vector<RangeImage>& images,
                                    const nlohmann::ordered_json& peaks, int most_threads,
                                    const InterruptGuard& interrupt);

}  // namespace hqslam::tools
