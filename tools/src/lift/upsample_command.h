#pragma once

#include <optional>
#include <string>

#include "recording/recording_choice.h"

namespace CLI {
class App;
}

namespace hqslam::tools {

/// sensor empty: as UpsamplingRequest says
struct UpsampleOptions : InputChoice, ConfidenceChoice {
  std::string weights;  ///< this one
  std::string method;   ///< or this one
  std::string out;
  int threads = 0;  ///< 0: what OpenMP chooses
  bool bin = false;
  bool pcd = false;
  bool png = false;
};

void declare_upsample(CLI::App& app, UpsampleOptions& options);
/// Returns an ExitStatus. Throws Error.
int upsample_command(const UpsampleOptions& options);

}  // namespace hqslam::tools
