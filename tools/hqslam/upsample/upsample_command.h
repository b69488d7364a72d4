#pragma once

#include <string>

#include "recording/recording_choice.h"
#include "upsample/upsample_output.h"

namespace hqslam::tools {

/// sensor empty: as upsampled_input has it
struct UpsampleOptions : InputChoice, UpsamplingChoice {
  std::string poses;  ///< for networks with a memory; empty: they have none of earlier scans
  std::string out;
  int threads = 0;  ///< 0: what OpenMP chooses
  UpsampledFormats formats;
};

void declare(CLI::App& app, UpsampleOptions& options);
/// Returns an ExitStatus. Throws Error.
int run(const UpsampleOptions& options);

}  // namespace hqslam::tools
