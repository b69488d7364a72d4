#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/sim/drive.h"
#include "recording/recording_choice.h"
#include "table/table_methods.h"

namespace hqslam::tools {

struct TableOptions {
  std::vector<std::string> drives = {"town", "hills"};  ///< simulated drives and recordings
  std::vector<std::string> methods = {};                ///< empty: table_methods()
  std::vector<std::string> weights = {};                ///< files that become rows of their own
  InputChoice reading = {};  ///< how recordings are read; its input is not used
  std::optional<std::int64_t> scans = {};
  std::string sensor_errors = "typical";  ///< of simulated drives: sim::sensor_errors_names()
  std::string seeds = {};    ///< "1..10" or "3,5": every drive from each of these seeds
  std::string against = {};  ///< the row that others are paired with; empty: see TablePlan
  std::string out = {};
  int threads = 0;  ///< 0: what OpenMP chooses
};

/// The sensor of simulated drives, which is the paper's.
inline constexpr const char* kSimulatedSensor = "os1-64";

/// A drive of the table.
struct TableDrive {
  std::string name;  ///< in the table and of its folders
  InputChoice recording;
  std::optional<sim::DriveSpec> simulated;  ///< to be simulated into the recording's folder
};

struct TablePlan {
  std::vector<TableDrive> drives;
  bool over_seeds = false;  ///< drives of a kind are evaluated together
  std::vector<TableMethod> methods;
  /// The method that the others are paired with: the one of --against or else linear interpolation
  /// or else the first.
  std::size_t against = 0;
  std::optional<std::int64_t> scans;  ///< of each drive that are used; nothing: all
  std::string out;
};

/// Throws Error for an unknown drive or method.
TablePlan plan_table(const TableOptions& options);
/// Throws Error for a recording without all rows, and for weights that cannot upsample it.
void require_fitting_drives(const TablePlan& plan);

}  // namespace hqslam::tools
