#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "table/bootstrap.h"
#include "table/table_errors.h"
#include "table/table_methods.h"

namespace hqslam::tools {

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
