#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "files/result_files.h"
#include "hqslam/slam/occupancy_grid.h"
#include "run/dense_map.h"
#include "run/slam_run.h"
#include "timing/timing.h"

namespace hqslam::tools {

/// covariances.csv: a line per scan, its stamp in seconds, how the mapping located it, and the 6x6
/// covariance of its pose, row after row; before them two lines that describe it and name the
/// columns.
std::string covariances_csv(const SlamRun& run);

/// The folder that a run writes into: trajectory.tum, trajectory.kitti, covariances.csv,
/// map.pcd, timings.json and report.html, saved_map.npz if it was asked for, and those of a dense
/// map and an occupancy grid if there are any. Every file is written under another name first and
/// then renamed, so that each is valid whenever the program stops. No other file in the folder is
/// touched.
class RunOutput {
 public:
  /// Touches nothing yet. Throws Error if one of the files is there and was not written by hqslam,
  /// or is one of `inputs`.
  explicit RunOutput(const std::string& folder, const Paths& inputs = {});
  /// Leaves no folder behind that it made for nothing.
  ~RunOutput();
  RunOutput(const RunOutput&) = delete;
  RunOutput& operator=(const RunOutput&) = delete;

  /// Makes the folder, finds out whether it takes files, and locks it: what the first checkpoint
  /// does, where results come long after. Throws Error, also if another program writes into it.
  void prepare();
  const std::filesystem::path& folder() const { return folder_; }
  /// Whether so much time has passed since the last checkpoint that another is worth writing.
  bool checkpoint_due() const;
  /// The trajectory and the timings so far. The first call makes the folder, locks it and removes
  /// the covariances, the maps and the report of an earlier run, which would belong to another
  /// trajectory. Throws
  /// Error, also if another program writes into the folder.
  void write_checkpoint(const SlamRun& run);
  /// Everything.
  void write_results(const SlamRun& run);
  /// After write_results: the grid's files (occupancy_grid.h), and the report again, with the grid.
  void write_occupancy_grid(const SlamRun& run, const slam::OccupancyMap& map);
  /// After those: the dense map's files (dense_map.h), and the report again, with the dense map.
  void write_dense_map(const SlamRun& run, const DenseMapRun& dense_map);

 private:
  std::string path(const char* result) const { return (folder_ / result).string(); }
  std::filesystem::path folder_;
  SteadyClock::time_point last_checkpoint_ = SteadyClock::now();
  double last_duration_s_ = 0.0;  ///< what the last checkpoint took
  bool first_ = true;
  bool made_folder_ = false;
  std::optional<FolderLock> lock_;          ///< from the first checkpoint on
  std::optional<slam::OccupancyMap> grid_;  ///< thinned, for the report
};

/// timings.json: medians, 95th percentiles and maxima per stage in milliseconds, counts of
/// statuses, scans per second, and the same per scan.
std::string timings_json(const SlamRun& run);

}  // namespace hqslam::tools
