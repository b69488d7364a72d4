#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/nn/instruction_set.h"
#include "hqslam/nn/weights_file.h"
#include "terminal/terminal.h"
#include "timing/timing.h"

namespace hqslam::tools {

/// The processor's peak of multiply-adds.
struct MultiplyAddPeak {
  nn::InstructionSet instruction_set = nn::InstructionSet::kPortable;
  int threads = 1;
  double gflops = 0.0;
};
/// The peaks of every available instruction set with 1 to `most_threads` threads.
std::vector<MultiplyAddPeak> measure_peaks(int most_threads);

/// Times of the whole network, filter included, on many scans.
struct NetworkRun {
  nn::InstructionSet instruction_set = nn::InstructionSet::kPortable;
  int threads = 1;
  int frames = 0;
  Distribution frame_ms;
  double gflops = 0.0;      ///< at the median
  double peak_share = 0.0;  ///< of the peak of the same instruction set and threads
};

/// The time of one kind of step, measured alone; all calls for a frame together.
struct NetworkStepTiming {
  std::string name;
  double gmac = 0.0;  ///< 0: not a convolution
  double ms = 0.0;    ///< median
};
struct NetworkSteps {
  int threads = 1;
  std::vector<NetworkStepTiming> steps;
};

/// Times of a convolution and of its reference, written as its formula; one thread.
struct ReferenceRatio {
  std::string layer;
  double fast_ms = 0.0;
  double reference_ms = 0.0;
};

struct NetworkTiming {
  std::string path;
  std::string name;  ///< "du-or"
  std::int64_t parameters = 0;
  double gmac = 0.0;  ///< per frame
  std::vector<NetworkRun> runs;
  nn::InstructionSet steps_instruction_set = nn::InstructionSet::kPortable;
  std::vector<NetworkSteps> steps;
  std::optional<ReferenceRatio> reference;
};

/// Whether the images have the shape that the network takes.
bool takes(const nn::Weights& weights, const std::vector<RangeImage>& images);

/// images: all rows of a sensor of the network's shape.
NetworkTiming time_network(const std::string& path, const nn::Weights& weights,
                           const std::vector<RangeImage>& images,
                           const std::vector<MultiplyAddPeak>& peaks, int most_threads,
                           const InterruptGuard& interrupt);

void to_json(nlohmann::ordered_json& json, const Distribution& distribution);
void to_json(nlohmann::ordered_json& json, const MultiplyAddPeak& peak);
void to_json(nlohmann::ordered_json& json, const NetworkTiming& network);

/// Prints tables; nothing if no network was measured.
void print_networks(const std::vector<MultiplyAddPeak>& peaks,
                    const std::vector<NetworkTiming>& networks);

/// Prints the instruction sets that networks can use here and the one that they use.
void print_instruction_sets(bool json);

}  // namespace hqslam::tools
