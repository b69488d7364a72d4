#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/evaluation/drift.h"
#include "hqslam/evaluation/trajectory_error.h"
#include "laboratory/table/table_plan.h"
#include "laboratory/table/table_result.h"
#include "recording/reference.h"

namespace hqslam::tools {

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

/// Nothing if fewer than 3 poses can be paired.
std::optional<ErrorFigures> error_figures(const Trajectory& estimate, const Trajectory& reference);

/// What the table says of one method on one drive; arrays: loop closing off and on.
struct MethodFigures {
  TableMethod method;
  TableResult result;
  /// Against LiDAR-64's trajectory with the same loop closing; nothing for LiDAR-64 itself.
  std::array<std::optional<ErrorFigures>, 2> against_all_rows;
  std::array<std::optional<ErrorFigures>, 2> against_truth;
  std::vector<Slip> slips;  ///< against the truth, loop closing off

  /// Scans per second, by the median; nothing for methods that do not upsample.
  std::optional<double> upsampling_fps() const;
  /// Of upsampling, making points and SLAM together, by the total time.
  double chain_fps(std::size_t loop_closing) const;
};

struct DriveFigures {
  std::string name;
  std::string kind;        ///< town, hills, ...; of a simulated drive
  std::uint64_t seed = 0;  ///< the same
  std::string sensor;
  std::string truth;  ///< path; empty: none
  std::int64_t scans = 0;
  LeftOut left_out;                    ///< of these scans
  std::vector<MethodFigures> methods;  ///< those whose results are there
};

/// Computes every error from the results' trajectories.
DriveFigures drive_figures(const TableDrive& drive, const std::string& sensor,
                           const std::vector<TableMethod>& methods,
                           const std::vector<TableResult>& results,
                           const std::optional<TrajectoryFile>& truth);

/// The method of that name, nullptr if its result is not there.
const MethodFigures* find_method(const DriveFigures& drive, const std::string& name);

}  // namespace hqslam::tools
