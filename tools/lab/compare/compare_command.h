#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "recording/recording_choice.h"

namespace CLI {
class App;
}

namespace hqslam::tools {

struct CompareOptions : InputChoice {
  std::vector<std::string> weights;
  std::string poses;  ///< for networks with a memory; empty: they have none of other scans
  bool no_look_ahead = false;
  int rows = 16;  ///< that are measured
  std::int64_t every = 1;
  std::string json;  ///< file to write; empty: none
  bool layers = false;
  int threads = 0;  ///< 0: what OpenMP chooses
};

void declare(CLI::App& app, CompareOptions& options);
/// Returns an ExitStatus. Throws Error.
int run(const CompareOptions& options);

}  // namespace hqslam::tools
