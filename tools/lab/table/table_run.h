#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/trajectory.h"
#include "table/table_plan.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

/// Simulates the drives that are not in their folders, as many side by side as OpenMP has threads.
/// Returns false if it was interrupted. Throws Error.
bool simulate_missing(const TablePlan& plan, const InterruptGuard& interrupt);

/// The runs of a drive whose scans are there.
struct DriveRuns {
  TableDrive drive;
  std::int64_t scans = 0;  ///< of the recording that are used
  /// Per method the TUM file with its trajectory, results/DRIVE/METHOD-KEY.tum in the table's
  /// folder: a run is finished once it is there. KEY is a hash of the program, of the weights, and
  /// of the recording and how it is read.
  std::vector<std::string> paths;
};
/// The runs of all drives of the plan. Throws Error.
std::vector<DriveRuns> runs_of(const TablePlan& plan);

/// Does the runs that are not finished: upsampling and SLAM without loop closing, as many runs side
/// by side as OpenMP has threads. Unreadable scans are left out, with a line on stderr. Returns
/// false if it was interrupted. Throws Error, also if no scan is readable.
bool run_missing(const std::vector<DriveRuns>& runs, const TablePlan& plan,
                 const InterruptGuard& interrupt);

/// A drive on which all runs are finished.
struct FinishedDrive {
  TableDrive drive;
  std::int64_t scans = 0;                ///< of the recording that are used
  std::vector<Trajectory> trajectories;  ///< per method: the pose in its map of every scan
  std::optional<Trajectory> truth;       ///< nothing: unknown
};
std::vector<FinishedDrive> finished_drives(const std::vector<DriveRuns>& runs);

/// 16 digits that change with the program.
std::string program_hash();

}  // namespace hqslam::tools
