#pragma once

#include <string>
#include <vector>

#include "run/dense_map_run.h"
#include "run/slam_run.h"
#include "run/slam_settings.h"
#include "terminal/interrupt.h"

namespace hqslam::tools {

struct RunOptions : InputChoice, LiftingChoice {
  std::string out;
  std::string reference;  ///< empty: truth.tum in a folder written by `hqslam simulate`, or none
  int threads = 0;        ///< 0: what OpenMP chooses
  SlamSettings slam;
  bool save_map = false;
  std::string map_file;       ///< to be located in; empty: a map of its own is made
  std::vector<double> start;  ///< x and y in metres, yaw in degrees; empty: anywhere
  bool dense_map = false;
  DenseMapChoice map;
};

void declare_run(CLI::App& app, RunOptions& options);

/// Runs and writes the results, printing nothing but progress and warnings. Without a single scan
/// nothing is written. Throws Error, also if the first scan cannot be read.
SlamRun run_and_write(const RunOptions& options, const InterruptGuard& interrupt);

/// Returns an ExitStatus. Throws Error.
int run_command(const RunOptions& options);

}  // namespace hqslam::tools
