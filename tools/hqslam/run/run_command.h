#pragma once

#include <string>
#include <vector>

#include "hqslam/slam/dense_map.h"
#include "recording/recording_choice.h"
#include "run/dense_map.h"
#include "run/occupancy_grid.h"
#include "run/slam_run.h"
#include "run/slam_settings.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

struct RunOptions : InputChoice, UpsamplingChoice {
  std::string out;
  std::string
      reference;    ///< empty: truth.tum in a folder written by `hqslam-lab simulate`, or none
  int threads = 0;  ///< 0: what OpenMP chooses
  SlamSettings slam;
  bool save_map = false;
  std::string map_file;       ///< to be located in; empty: a map of its own is made
  std::vector<double> start;  ///< x and y in metres, yaw in degrees; empty: anywhere
  bool dense_map = false;
  slam::DenseMapOptions map;
  bool occupancy_grid = false;
  OccupancyGridChoice grid;
};

void declare(CLI::App& app, RunOptions& options);
/// Returns an ExitStatus. Throws Error.
int run(const RunOptions& options);

/// Runs and writes the results, printing nothing but progress and warnings. Without a single scan
/// nothing is written. Throws Error, also if the first scan cannot be read.
SlamRun run_and_write(const RunOptions& options, const InterruptGuard& interrupt);

}  // namespace hqslam::tools
