#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hqslam/nn/hqs/super_resolver.h"
#include "recording/recording_choice.h"

namespace CLI {
class App;
}

namespace hqslam::tools {

struct CompareOptions : InputChoice {
  std::vector<std::string> weights;
  std::int64_t every = 1;
  std::string json;   ///< file to write; empty: none
  std::string curve;  ///< page to write about the last weights' confidence; empty: none
  float tolerance_m = nn::SuperResolverOptions{}.tolerance_m;  ///< of that confidence
  bool filters = false;
  bool layers = false;
  std::string protocol = "own";  ///< or "tulip"
  int threads = 0;               ///< 0: what OpenMP chooses
};

/// In every file that --json writes: tells it from others.
inline constexpr const char* kCompareJsonMarker = "hqslam compare";

void declare_compare(CLI::App& app, CompareOptions& options);
/// Returns an ExitStatus. Throws Error.
int compare_command(const CompareOptions& options);

}  // namespace hqslam::tools
