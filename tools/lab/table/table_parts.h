#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "table/table_run.h"
#include "table/table_statistics.h"

namespace hqslam::tools {

/// Nothing if fewer than 3 poses can be paired.
std::optional<TrajectoryErrors> trajectory_errors(const Trajectory& estimate,
                                                  const Trajectory& reference);

/// Where one method's errors are.
struct ErrorPath {
  std::string method;                   ///< its title
  double rmse_m = 0.0;                  ///< of all poses
  std::vector<double> x_m, y_m;         ///< aligned with the reference
  std::vector<double> distance_m = {};  ///< along the reference
  std::vector<double> error_m = {};     ///< of the position
};

/// The paper's figure 2: the paths of a drive in the frame of the reference, evenly thinned to at
/// most kMostPathPoses poses, to the millimetre.
struct ErrorMap {
  std::vector<double> x_m, y_m;  ///< of the reference
  std::vector<ErrorPath> paths;  ///< of the methods, but not of the reference itself
};
inline constexpr std::size_t kMostPathPoses = 1000;

/// The name of the part that has the drives of all others.
inline constexpr const char* kAllDrives = "all";

/// A part of the table: one drive, or several, against one kind of reference.
struct TablePart {
  std::string name;
  std::string reference;  ///< "the truth", "LiDAR-64"
  TableSample sample;
  ErrorMap map = {};  ///< of one drive that is evaluated alone
};
/// Over seeds: all drives against the truth, then, where there are several kinds, those of each.
/// Otherwise every drive against the truth, if it is known, and against LiDAR-64, if that is a row.
/// Drives of which fewer than 3 poses can be compared are left out.
std::vector<TablePart> parts_of(const TablePlan& plan, const std::vector<FinishedDrive>& drives);

}  // namespace hqslam::tools
