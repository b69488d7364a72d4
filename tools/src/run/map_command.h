#pragma once

#include <string>

#include "run/dense_map_run.h"

namespace hqslam::tools {

struct MapOptions : InputChoice, LiftingChoice {
  std::string poses;
  std::string out;
  int threads = 0;  ///< 0: what OpenMP chooses
  DenseMapChoice map;
};

void declare_map(CLI::App& app, MapOptions& options);
/// Returns an ExitStatus. Throws Error.
int map_command(const MapOptions& options);

/// "dense map: 1234567 points, one per 0.1 m, of 300 scans, 12.3 s"
std::string dense_map_summary(const DenseMapRun& run);

}  // namespace hqslam::tools
