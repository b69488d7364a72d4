#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "files/result_files.h"
#include "hqslam/slam/occupancy_grid.h"
#include "recording/recording_choice.h"
#include "recording/scan_poses.h"
#include "terminal/command_options.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

/// A user's options of an occupancy grid.
struct OccupancyGridChoice {
  double resolution_m = slam::OccupancyGridOptions().resolution_m;
  std::vector<double> band_m = {slam::OccupancyGridOptions().lowest_obstacle_m,
                                slam::OccupancyGridOptions().highest_obstacle_m};
};
/// --occupancy-grid, which sets `wanted` and needs `needs`, --grid-cell and --grid-band.
void declare_occupancy_grid(Command& command, bool& wanted, OccupancyGridChoice& choice,
                            const std::vector<const char*>& needs = {});
/// Throws Error.
slam::OccupancyGridOptions options_of(const OccupancyGridChoice& choice);

struct OccupancyGridRun {
  slam::OccupancyMap map;  ///< empty if it was interrupted
  std::string summary;     ///< "occupancy grid: 900 x 700 cells of 0.1 m, ..."
};
/// Reads the recording three times (MapInput): for the ground, for what stands on it, and for what
/// is seen through. Throws Error.
OccupancyGridRun build_occupancy_grid(const InputChoice& recording,
                                      const UpsamplingChoice& upsampling, const ScanPoses& poses,
                                      const OccupancyGridChoice& choice,
                                      const InterruptGuard& interrupt);

inline constexpr const char* kOccupancyGridFiles[] = {"map.pgm", "map.yaml"};

/// Throws Error if one of the files is there and was not written by hqslam, or is one of `inputs`.
void guard_occupancy_grid(const std::filesystem::path& folder, const Paths& inputs);
/// Both or none, each whole whenever the program stops. Throws Error.
void write_occupancy_grid(const slam::OccupancyMap& map, const std::filesystem::path& folder);

}  // namespace hqslam::tools
