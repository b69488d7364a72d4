#pragma once

#include <string>

#include "recording/recording_choice.h"
#include "run/map_choice.h"
#include "run/slam_run.h"
#include "run/slam_settings.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

struct RunOptions : InputChoice, UpsamplingChoice, MapChoice {
  std::string out;
  std::string
      reference;  ///< empty: truth.tum in a folder written by `hqslam-lab simulate`, or none
  bool open = false;
  int threads = 0;  ///< 0: what OpenMP chooses
  bool no_calibration = false;
  SlamSettings slam;
};

void declare(CLI::App& app, RunOptions& options);
/// Returns an ExitStatus. Throws Error.
int run(const RunOptions& options);

/// Runs and writes the results, printing nothing but progress and warnings. Without a single scan
/// nothing is written. Throws Error, also if the first scan cannot be read.
SlamRun run_and_write(RunOptions options, const InterruptGuard& interrupt);

}  // namespace hqslam::tools
