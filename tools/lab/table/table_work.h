#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/sensor_model.h"
#include "table/table_figures.h"
#include "table/table_plan.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

/// A drive whose recording exists.
struct PreparedDrive : TableDrive {
  SensorModel sensor;      ///< of the recording
  std::int64_t scans = 0;  ///< of the recording that are used
  std::string identity;    ///< identity_of(drive, scans)
  std::string results;     ///< folder
};

/// Methods that share one pass of upsampling over one drive.
struct TablePass {
  PreparedDrive drive;
  std::vector<TableMethod> methods;
  std::vector<TableSettings> settings;  ///< of each
  bool loop_closing = true;             ///< whether SLAM also runs with it
  std::int64_t scored_scans = 0;        ///< at most; see run_pass
};

/// Upsamples the drive once and hands every scan to SLAM, for each method without and, if the pass
/// has it, with loop closing. Calls `on_scan` after each scan. Upsampling, making points of its
/// result, and each SLAM are timed separately; reading, scoring and writing are not. At most
/// `scored_scans` scans, evenly spread, are compared with the recording's rows. Unreadable scans
/// are left out and counted. Returns nothing if it was interrupted. Throws Error, also if no scan
/// is readable.
std::vector<TableResult> run_pass(const TablePass& pass, const InterruptGuard& interrupt,
                                  const std::function<void()>& on_scan);
inline constexpr std::int64_t kMostScoredScans = 200;
inline constexpr std::int64_t kScoredPerSeed = 20;  ///< of each of many drives

/// The state of one drive of the table.
struct DriveWork {
  TableDrive drive;
  std::optional<PreparedDrive> prepared;  ///< once its recording exists
  std::vector<TablePass> passes;          ///< that are left to do
};

/// The work that is left, in the order of the plan's drives. Throws Error, before anything is
/// written, for a recording that is not fit for a table.
std::vector<DriveWork> work_of(const TablePlan& plan, const TableOptions& options);

/// Simulates and runs what is missing, and saves every result: drive by drive, or, over seeds, as
/// many drives side by side as OpenMP has threads, with one thread each. Returns false if it was
/// interrupted. Throws Error, once all drives have stopped.
bool run_missing(std::vector<DriveWork>& works, const TablePlan& plan, const TableOptions& options,
                 const InterruptGuard& interrupt);

/// The existing results of these methods.
struct FoundResults {
  std::vector<TableMethod> methods;
  std::vector<TableResult> results;
};
FoundResults results_of(const PreparedDrive& drive, const std::vector<TableMethod>& methods,
                        bool loop_closing);

}  // namespace hqslam::tools
