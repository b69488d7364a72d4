#pragma once

#include <string>

#include "hqslam/slam/dense_map.h"
#include "recording/recording_choice.h"
#include "run/dense_map.h"
#include "run/occupancy_grid.h"

namespace hqslam::tools {

struct MapOptions : InputChoice, UpsamplingChoice {
  std::string poses;
  std::string out;
  int threads = 0;  ///< 0: what OpenMP chooses
  slam::DenseMapOptions map;
  bool occupancy_grid = false;
  OccupancyGridChoice grid;
};

void declare(CLI::App& app, MapOptions& options);
/// Returns an ExitStatus. Throws Error.
int run(const MapOptions& options);

}  // namespace hqslam::tools
