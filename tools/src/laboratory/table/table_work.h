#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/ranks.h"
#include "hqslam/core/sensor_model.h"
#include "laboratory/table/table_plan.h"
#include "laboratory/table/table_result.h"
#include "laboratory/table/table_run.h"
#include "terminal/interrupt.h"

namespace hqslam::tools {

/// A drive whose recording is there.
struct PreparedDrive {
  TableDrive drive;
  SensorModel sensor;
  std::int64_t scans = 0;
  std::string identity;  ///< identity_of(drive, scans)
  std::string results;   ///< folder
};

/// One drive on its way through the table.
struct DriveWork {
  TableDrive drive;
  std::optional<PreparedDrive> prepared;  ///< once its recording is there
  std::vector<TablePass> passes;          ///< that are left to do
};

/// What a plan leaves to do, in the order of its drives. Throws Error, before anything is written,
/// for a recording that a table cannot be made of.
std::vector<DriveWork> work_of(const TablePlan& plan, const TableOptions& options);

/// Simulates and runs what is missing, and saves every result: drive by drive, or, over seeds, as
/// many drives side by side as OpenMP has threads, with one thread each. Several ranks share drives
/// to be simulated, then drives and methods to be run, and save into the same folder. Returns, on
/// all ranks, false if any was interrupted. Throws Error, once all drives of this rank have
/// stopped.
bool run_missing(std::vector<DriveWork>& works, const TablePlan& plan, const TableOptions& options,
                 const InterruptGuard& interrupt, Ranks& ranks);

/// The results of these methods that are there, whoever computed them, and their methods.
struct FoundResults {
  std::vector<TableMethod> methods;
  std::vector<TableResult> results;
};
FoundResults results_of(const PreparedDrive& drive, const std::vector<TableMethod>& methods,
                        bool loop_closing);

}  // namespace hqslam::tools
