#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/sensor_model.h"
#include "hqslam/pipeline/pipeline.h"
#include "hqslam/sim/drive.h"
#include "recording/recording_choice.h"

namespace hqslam::tools {

struct TableMethod;

/// The inputs of SLAM beside the points: their sensor, which SLAM, and its options.
struct SlamSetup {
  SensorModel sensor;
  pipeline::PipelineOptions options;  ///< without upsampling
};

/// A change of one part of SLAM, to measure its effect: METHOD+NAME is METHOD with it.
struct SlamVariant {
  const char* name;
  const char* title;  ///< behind the method's, in the table
  bool (*applies)(const TableMethod& method);
  void (*change)(SlamSetup& setup);
};

/// All variants.
const std::vector<SlamVariant>& slam_variants();

/// The setup of SLAM for a method; `sensor`: of its clouds.
SlamSetup slam_setup(const TableMethod& method, const SensorModel& sensor, bool loop_closing);

struct TableOptions {
  std::vector<std::string> drives = {"town", "hills"};  ///< simulated drives and recordings
  std::vector<std::string> methods = {};                ///< empty: all
  std::vector<std::string> weights = {};                ///< files that become rows of their own
  InputChoice reading = {};    ///< how recordings are read; its input is not used
  std::string reference = {};  ///< true trajectory of the only recording among the drives
  std::optional<std::int64_t> scans = {};
  std::string sensor_errors = "typical";  ///< of simulated drives: sim::sensor_errors_names()
  std::string seeds = {};  ///< "1..10" or "3,5": every drive from each of these seeds
  /// With seeds: the row that others are paired with; empty: see TablePlan.
  std::string against = {};
  std::string out = {};
  int threads = 0;  ///< 0: what OpenMP chooses
};

/// Rows of a recording, and the number of them that are measured.
inline constexpr int kTableAllRows = 64;
inline constexpr int kTableMeasuredRows = 16;

/// A row of the table: a method that makes SLAM's input from a recording.
struct TableMethod {
  std::string name;               ///< for --methods and in file names
  std::string title;              ///< in the table
  int rows = kTableMeasuredRows;  ///< of the recording that are used
  /// The source of the rows between them: "" none, an interpolation, a kind of network (its weights
  /// come with the program) or a weights file.
  std::string source;
  bool filtered = false;  ///< whether the filter at the end runs over a network's result
  const SlamVariant* variant = nullptr;  ///< of SLAM; nullptr: SLAM as it is
};

/// The default rows of the table, in order.
const std::vector<TableMethod>& table_methods();
/// The names of the default rows.
std::vector<std::string> table_method_names();
bool uses_network(const TableMethod& method);
/// Whether the other rows are compared with this one's trajectory: all rows, SLAM as it is.
bool is_reference(const TableMethod& method);

/// The weights that `method` needs for a sensor, "" if it needs none. Throws Error if no such
/// weights come with the program.
std::string weights_of(const TableMethod& method, const std::string& sensor_name);

/// Methods with the same rows from the same source share a pass over the drive; they differ only in
/// filter and SLAM. The pass of all rows is the first: its trajectory is the reference of the
/// others.
std::vector<std::vector<TableMethod>> passes_of(const std::vector<TableMethod>& methods);

/// A drive of the table.
struct TableDrive {
  std::string name;  ///< in the table and of its folders
  InputChoice recording;
  std::string reference;  ///< path of the true trajectory; empty: the recording's own, or none
  std::optional<sim::DriveSpec> simulated;  ///< to be simulated into the recording's folder
};

struct TablePlan {
  std::vector<TableDrive> drives;
  bool over_seeds = false;           ///< many drives, evaluated together, without loop closing
  std::vector<TableMethod> methods;  ///< to be run
  /// Methods in the table if they have results: those to be run and, except over seeds, all others.
  std::vector<TableMethod> shown;
  /// Over seeds, the method that the others are paired with: the one of --against or else linear
  /// interpolation or else the first.
  std::size_t against = 0;
};

/// Throws Error for an unknown drive or method.
TablePlan plan_table(const TableOptions& options);

}  // namespace hqslam::tools
