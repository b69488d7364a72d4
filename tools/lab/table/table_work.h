#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "hqslam/core/sensor_model.h"
#include "table/table_figures.h"
#include "table/table_plan.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

/// A method on a drive.
struct TableRun {
  TableMethod method;
  TableSettings settings;
};
/// Runs that share one pass of upsampling over one drive.
using TablePass = std::vector<TableRun>;

/// A drive of the table, and what is left to do on it.
struct DriveWork {
  TableDrive drive;
  bool is_prepared = false;  ///< its recording exists; all below is of it
  SensorModel sensor;
  std::int64_t scans = 0;  ///< that are used
  std::string identity;    ///< identity_of(drive, scans)
  std::string results;     ///< folder
  std::vector<TablePass> passes;
};

/// Upsamples a prepared drive once and hands every scan to SLAM, for each method without and, if
/// its settings have it, with loop closing. Calls `on_scan` after each scan. Upsampling, making
/// points of its result, and each SLAM are timed separately; reading, scoring and writing are not.
/// At most `scored_scans` scans, evenly spread, are compared with the recording's rows. Unreadable
/// scans are left out and counted. Returns nothing if it was interrupted. Throws Error, also if no
/// scan is readable.
std::vector<TableResult> run_pass(const DriveWork& work, const TablePass& pass,
                                  std::int64_t scored_scans, const InterruptGuard& interrupt,
                                  const std::function<void()>& on_scan);
inline constexpr std::int64_t kMostScoredScans = 200;
inline constexpr std::int64_t kScoredPerSeed = 20;  ///< of each of many drives

/// The work that is left, in the order of the plan's drives. Throws Error, before anything is
/// written, for a recording that is not fit for a table.
std::vector<DriveWork> work_of(const TablePlan& plan, const TableOptions& options);

/// Simulates and runs what is missing, and saves every result: drive by drive, or, over seeds, as
/// many drives side by side as OpenMP has threads, with one thread each. Returns false if it was
/// interrupted. Throws Error, once all drives have stopped.
bool run_missing(std::vector<DriveWork>& works, const TablePlan& plan, const TableOptions& options,
                 const InterruptGuard& interrupt);

/// The existing results of the methods that the plan shows, on a prepared drive.
std::vector<TableResult> results_of(const DriveWork& work, const TablePlan& plan);

}  // namespace hqslam::tools
