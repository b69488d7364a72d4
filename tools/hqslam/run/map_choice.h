#pragma once

#include <string>
#include <vector>

#include "hqslam/pipeline/pipeline.h"
#include "recording/recording_choice.h"
#include "run/dense_map.h"
#include "run/occupancy_grid.h"
#include "run/run_output.h"
#include "run/slam_settings.h"

namespace hqslam::tools {

/// The map in which a drive is located, and the maps that are made of it.
struct MapChoice {
  bool save_map = false;
  std::string map_file;       ///< in which the drive is located; empty: it makes its own map
  std::vector<double> start;  ///< x and y in metres, yaw in degrees; empty: anywhere
  bool dense_map = false;
  slam::DenseMapOptions map;
  bool occupancy_grid = false;
  OccupancyGridChoice grid;
};
/// --save-map, --map, --start, --dense-map and --occupancy-grid with what belongs to them. needs:
/// options without which the last two have no scans to read.
void declare_maps(Command& command, MapChoice& choice, const std::vector<const char*>& needs = {});

/// Which SLAM, in which map. Throws Error.
pipeline::PipelineOptions pipeline_options(const SlamSettings& slam, const MapChoice& choice);

/// Makes the grid and the dense map of a finished run whose other results are written: an error
/// costs that map alone and goes into run.failed_maps.
void add_maps(const InputChoice& recording, const UpsamplingChoice& upsampling,
              const MapChoice& choice, const InterruptGuard& interrupt, RunOutput& output,
              SlamRun& run);

/// kOk, or why a map is missing, with the lines on stderr that explain it.
int exit_status_of_maps(const MapChoice& choice, const SlamRun& run);

}  // namespace hqslam::tools
