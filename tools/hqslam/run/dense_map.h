#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "files/result_files.h"
#include "hqslam/slam/dense_map.h"
#include "recording/recording_choice.h"
#include "recording/scan_poses.h"
#include "run/map_input.h"
#include "terminal/command_options.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

struct SlamRun;

/// --map-voxel and --map-confidence. needs: options without which they have no effect.
void declare_dense_map(Command& command, slam::DenseMapOptions& options,
                       const std::vector<const char*>& needs = {});

/// The poses of a run, but for scans that were not located, or are in another submap.
ScanPoses poses_of(const SlamRun& run);

/// A dense map, finished or not, and how its scans were put into it.
struct DenseMapRun : MapReading {
  std::vector<slam::DenseMapPoint> points;  ///< in the frame of the poses
  std::vector<float> intensity;             ///< of the points; empty: the recording has none
  double voxel_m = 0.0;
  bool is_full = false;  ///< points were left out because memory is bounded
  double wall_s = 0.0;
};

/// Reads the recording twice (MapInput): first all scans are put into the map, then they vote about
/// what they saw through.
DenseMapRun build_dense_map(const InputChoice& recording, const UpsamplingChoice& upsampling,
                            const ScanPoses& poses, const slam::DenseMapOptions& options,
                            const InterruptGuard& interrupt);

/// dense_map.ply is written first: it is the marker by which the other is recognized.
inline constexpr const char* kDenseMapFiles[] = {"dense_map.pcd", "dense_map.ply"};

/// Throws Error if one of the files is there and was not written by hqslam, or is one of `inputs`.
void guard_dense_map(const std::filesystem::path& folder, const Paths& inputs);
/// Writes each file under another name first and renames it then, so that each is whole whenever
/// the program stops; makes the folder. Throws Error, leaving no half of a file.
void write_dense_map(const DenseMapRun& run, const std::filesystem::path& folder);

/// "dense map: 1234567 points, one per 0.1 m, of 300 scans, 12.3 s"
std::string dense_map_summary(const DenseMapRun& run);

}  // namespace hqslam::tools
