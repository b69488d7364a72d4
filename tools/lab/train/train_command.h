#pragma once

#include <cstdint>
#include <string>

#include "recording/recording_choice.h"

namespace CLI {
class App;
}

namespace hqslam::tools {

struct TrainOptions {
  std::string config;
  InputChoice recording;   ///< to train on, in the place of a configuration
  std::string start_from;  ///< weights, with a recording
  std::int64_t steps = 400;
  std::string out;
  std::string drives;  ///< empty: the folder "drives" in `out`
  int threads = 0;     ///< 0: what OpenMP chooses
};

void declare(CLI::App& app, TrainOptions& options);
/// Returns an ExitStatus. Throws Error.
int run(const TrainOptions& options);

}  // namespace hqslam::tools
