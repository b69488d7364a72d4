#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "table/table_figures.h"

namespace hqslam::tools {

/// A figure computed from a sample, with its interval.
struct Estimate {
  double value = 0.0;
  double low = 0.0;  ///< of the 95 % interval
  double high = 0.0;
};

/// A figure of a sample as a function of its members, in any order and possibly repeated; NaN where
/// they have no figure.
using SampleFigure = std::function<double(const std::vector<std::size_t>& members)>;

/// The figure of members 0 to n - 1, with its 95 % bootstrap interval by percentiles (Efron &
/// Tibshirani, 1993, chapter 13): n members are drawn with replacement 10,000 times, and 2.5 % of
/// the figures lie below, 2.5 % above. Draws that have no figure are left out; if most have none,
/// or n is 1 or less, the interval is (NaN, NaN). The draws are the same in every run and on every
/// machine.
Estimate bootstrap(std::size_t n, const SampleFigure& figure);

/// Drives that every method of the table finished, without loop closing, each against its truth.
struct TableSample {
  std::size_t against = 0;  ///< the method that the others are paired with
  std::vector<const DriveFigures*> drives;

  /// The methods, in the order of each drive's.
  const std::vector<TableResult>& methods() const { return drives.front()->methods; }
};

/// The drives among `all` that have figures against the truth for each of these methods, which are
/// all that they have.
TableSample sample_of(const std::vector<DriveFigures>& all, const TablePlan& plan);
/// Errors against the truth of a drive's method.
const ErrorFigures& errors_of(const DriveFigures& drive, std::size_t method);
/// The length of a drive's true path.
double path_m(const DriveFigures& drive);
/// The kinds of the sample's drives, each once.
std::vector<std::string> kinds_of(const TableSample& sample);
/// The part of the sample with the drives of one kind.
TableSample of_kind(const TableSample& sample, const std::string& kind);

/// Per drive the drift of a method, translation over pieces of kDriftPiece_m, minus that of the
/// method that it is paired with, %; NaN where a drive has none.
std::vector<double> drift_differences_percent(const TableSample& sample, std::size_t method);
/// On all drives together.
std::size_t slips_of(const TableSample& sample, std::size_t method);
/// Mean over the drives.
double slam_ms_of(const TableSample& sample, std::size_t method);

/// One figure of a method over all drives, in tables and in files. Means over drives, each drive
/// counting alike, with intervals over drives; NaN where there is none.
struct StatisticsColumn {
  const char* column;
  const char* key;  ///< in files; nullptr: not as an estimate
  int decimals;     ///< in tables
  bool of_others;   ///< not of the method that the others are paired with
  std::function<std::optional<Estimate>(const TableSample& sample, std::size_t method)> of;
};
const std::vector<StatisticsColumn>& summary_columns();
/// Beside the method that others are paired with, drive by drive, and beside LiDAR-16 and LiDAR-64.
const std::vector<StatisticsColumn>& pair_columns();

/// Per method its estimates, one per column.
using Estimates = std::vector<std::vector<std::optional<Estimate>>>;

/// The estimates of a part of a sample, for all drives "all".
struct PartStatistics {
  std::string name;
  TableSample sample;
  Estimates summary;
  Estimates pairs;
};
/// All drives, then those of each kind.
std::vector<PartStatistics> parts_of(const TableSample& sample);

}  // namespace hqslam::tools
