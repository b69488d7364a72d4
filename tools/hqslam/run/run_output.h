#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "files/result_files.h"
#include "report/turning_view.h"
#include "run/dense_map.h"
#include "run/slam_run.h"
#include "timing/timing.h"

namespace hqslam::tools {

/// The drive from above in the map frame, x to the right and y upwards, both axes in metres and of
/// one scale: the map's points faintly behind, the reference as a dashed line, the estimate
/// coloured by its error where there is a reference. HTML with inline SVG.
std::string trajectory_plot_html(const SlamRun& run);

/// What a run has to be looked at: its dense map if there is one, the features of its map, its
/// path, loops and scans, whose points are where the sensor was when it measured each. Other parts
/// of the map, if there are any, are not in it.
TurningView view_of(const SlamRun& run, const DenseMapRun* dense_map = nullptr);

/// report.html: one page that needs no other file and no network. Headline numbers, the trajectory
/// from above, the error over time and the time per stage; the dense map with its pictures, if
/// there is one.
std::string html_report(const SlamRun& run, const DenseMapRun* dense_map = nullptr);

/// covariances.csv: a line per scan, its stamp in seconds, how the mapping located it, and the 6x6
/// covariance of its pose, row after row; before them two lines that say what it is and name the
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
  /// After write_results: the dense map's files (dense_map.h), and the report again, with its
  /// pictures, which are made.
  void write_dense_map(const SlamRun& run, DenseMapRun& dense_map);

 private:
  std::string path(const char* result) const { return (folder_ / result).string(); }
  std::filesystem::path folder_;
  SteadyClock::time_point last_checkpoint_ = SteadyClock::now();
  double last_duration_s_ = 0.0;  ///< what the last checkpoint took
  bool first_ = true;
  bool made_folder_ = false;
  std::optional<FolderLock> lock_;  ///< from the first checkpoint on
};

/// timings.json: medians, 95th percentiles and maxima per stage in milliseconds, counts of
/// statuses, scans per second, and the same per scan.
std::string timings_json(const SlamRun& run);

}  // namespace hqslam::tools
