#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/sensor_model.h"
#include "hqslam/sim/drive.h"
#include "hqslam/slam/options.h"
#include "recording/recording_choice.h"

namespace hqslam::tools {

struct TableMethod;

/// What SLAM is told: the sensor behind the points, and its options.
struct SlamSetup {
  SensorModel sensor;
  slam::SlamOptions options;
  bool as_published = false;  ///< LeGO-LOAM as its paper has it instead, without options
};

/// One part of SLAM taken away or given back, to see what it is worth: METHOD+NAME is METHOD with
/// it.
struct SlamVariant {
  const char* name;
  const char* title;  ///< behind the method's, in the table
  bool (*applies)(const TableMethod& method);
  void (*change)(SlamSetup& setup);
};

/// Every variant that the program knows.
const std::vector<SlamVariant>& slam_variants();

/// "+NAME" of each.
std::vector<std::string> slam_variant_names();

/// What SLAM is told for a method: `sensor` is what its clouds come from.
SlamSetup slam_setup(const TableMethod& method, const SensorModel& sensor, bool loop_closing);

struct TableOptions {
  std::vector<std::string> drives = {"town", "hills"};  ///< simulated drives and recordings
  std::vector<std::string> methods = {};                ///< empty: all
  std::vector<std::string> weights = {};                ///< files that become rows of their own
  InputChoice reading = {};    ///< how recordings are read; its input is not looked at
  std::string reference = {};  ///< true trajectory of the only recording among the drives
  std::optional<std::int64_t> scans = {};
  std::string sensor_errors = "typical";  ///< of simulated drives: sim::sensor_errors_names()
  std::string seeds = {};  ///< "1..10" or "3,5": every drive from each of these seeds
  /// With seeds: the row that others are paired with; empty: see TablePlan.
  std::string against = {};
  std::string out = {};
  int threads = 0;  ///< 0: what OpenMP chooses
};

/// The table compares so many rows of a recording with all of them.
inline constexpr int kTableAllRows = 64;
inline constexpr int kTableMeasuredRows = 16;

/// A row of the table: a way from a recording to what SLAM gets to see.
struct TableMethod {
  std::string name;               ///< for --methods and in file names
  std::string title;              ///< in the table
  int rows = kTableMeasuredRows;  ///< of the recording that are looked at
  /// What fills the rows between them: "" nothing, an interpolation, a kind of network (its weights
  /// come with the program) or a weights file.
  std::string source;
  bool filtered = false;  ///< whether the filter at the end runs over a network's result
  const SlamVariant* variant = nullptr;  ///< of SLAM; nullptr: SLAM as it is
};

/// The rows of the table without a choice, in its order.
const std::vector<TableMethod>& table_methods();
/// Names of those rows.
std::vector<std::string> table_method_names();
bool uses_network(const TableMethod& method);
/// Whether the other rows are compared with this one's trajectory: all rows, SLAM as it is.
bool is_reference(const TableMethod& method);

/// The weights that `method` needs for a sensor, "" if it needs none. Throws Error if no such
/// weights come with the program.
std::string weights_of(const TableMethod& method, const std::string& sensor_name);

/// Methods that see the same rows, filled in the same way, share a pass over the drive: they differ
/// only in what follows. All rows come first: their trajectory is what the others are compared
/// with.
std::vector<std::vector<TableMethod>> passes_of(const std::vector<TableMethod>& methods);
/// Whether two methods do.
bool shares_pass(const TableMethod& method, const TableMethod& other);

/// A drive of the table.
struct TableDrive {
  std::string name;  ///< in the table and of its folders
  InputChoice recording;
  std::string reference;  ///< path of the true trajectory; empty: the recording's own, or none
  std::optional<sim::DriveSpec> simulated;  ///< to be simulated into the recording's folder
};

struct TablePlan {
  std::vector<TableDrive> drives;
  bool over_seeds = false;           ///< many drives, evaluated together
  bool loop_closing = true;          ///< whether SLAM also runs with it
  std::vector<TableMethod> methods;  ///< to be run
  /// In the table, if their results are there: those to be run and, but over seeds, all that the
  /// program knows.
  std::vector<TableMethod> shown;
  /// Over seeds which of the methods the others are paired with: the one that is named, else linear
  /// interpolation, else the first.
  std::size_t against = 0;
};

/// Throws Error for a drive or method that is not there.
TablePlan plan_table(const TableOptions& options);

}  // namespace hqslam::tools
