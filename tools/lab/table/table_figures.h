#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/trajectory.h"
#include "hqslam/evaluation/drift.h"
#include "hqslam/evaluation/trajectory_error.h"
#include "recording/reading.h"
#include "recording/reference.h"
#include "table/table_plan.h"

namespace hqslam::tools {

/// Every method runs through SLAM twice: without and with loop closing.
inline constexpr std::size_t kLoopClosingOff = 0;
inline constexpr std::size_t kLoopClosingOn = 1;
inline constexpr std::array<const char*, 2> kLoopClosingNames = {"off", "on"};

/// The settings that a result depends on; a result with other settings is not reused.
struct TableSettings {
  std::string build;         ///< result_sources_hash()
  std::string recording;     ///< hash of the scans that are used
  std::string sensor;        ///< name and hash of its model
  std::int64_t scans = 0;    ///< of the recording that are used
  bool loop_closing = true;  ///< whether SLAM also ran with it
  std::string method;
  std::string weights;  ///< name of the file; empty: no network
  std::string weights_hash;

  bool operator==(const TableSettings&) const = default;
};

/// Means over the scored scans.
struct ImageScores {
  std::int64_t scans = 0;
  double mae_all_m = 0.0;
  double mae_valid_m = 0.0;
  double outlier_share = 0.0;  ///< points farther than 0.5 m from the true cloud
};

struct NetworkSize {
  std::int64_t parameters = 0;
  std::int64_t multiply_adds = 0;
};

/// Times of SLAM alone.
struct SlamTimings {
  double total_s = 0.0;
  std::optional<double> first_ms;  ///< median of the first kTimedEnds scans
  std::optional<double> last_ms;   ///< and of the last; nothing where the two would overlap
};
inline constexpr std::size_t kTimedEnds = 500;

/// Everything that differs from run to run.
struct TableTimings {
  double upsampling_s = 0.0;   ///< of all scans together: image of few rows in, of all rows out
  double upsampling_ms = 0.0;  ///< median per scan
  double points_s = 0.0;       ///< from those images to points
  std::array<SlamTimings, 2> slam;
  int threads = 1;
  std::string processor;
  std::string instruction_set;  ///< of the network's kernels
};

/// Errors of a trajectory against another.
struct ErrorFigures {
  AbsolutePoseError ape;     ///< SE(3)-aligned
  double path_m = 0.0;       ///< of the reference, over the poses that were compared
  RelativePoseError pieces;  ///< over pieces of kDriftPiece_m; none if the path is shorter

  double ape_rmse_m() const { return ape.translation_statistics.rmse; }
  double ape_percent() const { return 100.0 * ape_rmse_m() / path_m; }
  /// RMSE over the pieces; nothing if there are none.
  std::optional<double> rpe_percent() const;
  std::optional<double> rpe_deg_per_100m() const;
};

/// One method on one drive.
struct TableResult {
  TableMethod method;
  TableSettings settings;
  std::optional<ImageScores> images;   ///< of methods that upsample
  std::optional<NetworkSize> network;  ///< of methods with a network
  /// Mapped pose of every scan, loop closing off and on; empty where SLAM did not run with it.
  std::array<Trajectory, 2> trajectory;
  std::int64_t loops_closed = 0;           ///< with loop closing
  std::vector<std::int64_t> scan_of_pose;  ///< of the recording, counted from 0
  LeftOut left_out;                        ///< unreadable scans of the recording
  TableTimings timings;

  // Computed by drive_figures; arrays: loop closing off and on.
  /// Against LiDAR-64's trajectory with the same loop closing; nothing for LiDAR-64 itself.
  std::array<std::optional<ErrorFigures>, 2> against_all_rows;
  std::array<std::optional<ErrorFigures>, 2> against_truth;
  std::vector<Slip> slips;  ///< against the truth, loop closing off

  /// Scans per second, by the median; nothing for methods that do not upsample.
  std::optional<double> upsampling_fps() const;
  /// Of upsampling, making points and SLAM together, by the total time.
  double chain_fps(std::size_t loop_closing) const;
  /// Mean time of SLAM per scan, loop closing off.
  double slam_ms() const;
};

/// Writes METHOD.json, METHOD-loop-closing-off.tum and -on.tum into the folder. Throws Error.
void save_result(const TableResult& result, const std::string& folder);

/// The result if it exists, is complete, and has these settings; without its method.
std::optional<TableResult> load_result(const TableSettings& settings, const std::string& folder);

/// Nothing if fewer than 3 poses can be paired.
std::optional<ErrorFigures> error_figures(const Trajectory& estimate, const Trajectory& reference);

struct DriveFigures {
  std::string name;
  std::string kind;        ///< town, hills, ...; of a simulated drive
  std::uint64_t seed = 0;  ///< of a simulated drive
  std::string sensor;
  std::string truth;  ///< path; empty: none
  std::int64_t scans = 0;
  LeftOut left_out;                  ///< of these scans
  std::vector<TableResult> methods;  ///< those with results
};

/// Computes every error from the results' trajectories.
DriveFigures drive_figures(const TableDrive& drive, const std::string& sensor,
                           std::vector<TableResult> results,
                           const std::optional<TrajectoryFile>& truth);

/// The method of that name, nullptr if it has no result.
const TableResult* find_method(const DriveFigures& drive, const std::string& name);

}  // namespace hqslam::tools
