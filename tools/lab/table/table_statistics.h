#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/evaluation/trajectory_error.h"
#include "table/bootstrap.h"
#include "table/table_methods.h"

namespace hqslam::tools {

/// Errors of a trajectory against a reference.
struct TrajectoryErrors {
  double ape_rmse_m = 0.0;   ///< of the position, SE(3)-aligned
  double path_m = 0.0;       ///< of the reference, over the poses that were compared
  RelativePoseError pieces;  ///< over pieces of kDriftPiece_m; none if the path is shorter
  std::vector<Slip> slips;
};

/// Errors of every method on one drive, against one reference.
struct DriveErrors {
  std::string kind;                        ///< town, hills, ...; of a recording its name
  std::optional<std::uint64_t> seed = {};  ///< of a simulated drive
  std::int64_t scans = 0;                  ///< of the recording
  std::int64_t scans_left_out = 0;         ///< of these
  std::vector<TrajectoryErrors> methods = {};

  double path_m() const { return methods.back().path_m; }
};

/// Drives that every method finished, each with its errors against the same kind of reference.
struct TableSample {
  std::vector<TableMethod> methods;  ///< in the order of each drive's
  std::size_t against = 0;           ///< the method that the others are paired with
  std::vector<DriveErrors> drives;
};
/// The kinds of the sample's drives, each once.
std::vector<std::string> kinds_of(const TableSample& sample);
/// The part of the sample with the drives of one kind.
TableSample of_kind(const TableSample& sample, const std::string& kind);

/// One figure of a method over all drives, in tables and in files. Means over drives, each drive
/// counting alike, with intervals over drives; NaN where there is none.
struct StatisticsColumn {
  const char* column;
  const char* key;         ///< in files
  int decimals;            ///< in tables
  bool of_others = false;  ///< not of the method that the others are paired with
  std::function<Estimate(const TableSample& sample, std::size_t method)> of;
};
const std::vector<StatisticsColumn>& summary_columns();
/// Beside the method that others are paired with, drive by drive, and beside LiDAR-16 and LiDAR-64.
/// The first is the mean of drift_differences_percent().
const std::vector<StatisticsColumn>& pair_columns();

/// Per drive the drift of a method, translation over pieces of kDriftPiece_m, minus that of the
/// method that it is paired with, %; NaN where a drive has none.
std::vector<double> drift_differences_percent(const TableSample& sample, std::size_t method);

}  // namespace hqslam::tools
