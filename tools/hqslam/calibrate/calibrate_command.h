#pragma once

#include <string>

#include "hqslam/pipeline/beam_check.h"
#include "recording/recording_choice.h"

namespace hqslam::tools {

struct CalibrateOptions : InputChoice {
  int rows = 0;                                  ///< of the recording; 0: all
  double path_m = pipeline::kCalibrationPath_m;  ///< of whose scans the beams are estimated
  std::string out;
  bool open = false;
};

void declare(CLI::App& app, CalibrateOptions& options);
/// Returns an ExitStatus. Throws Error.
int run(const CalibrateOptions& options);

}  // namespace hqslam::tools
