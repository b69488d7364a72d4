#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/evaluation/drift.h"
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

/// One method on one drive, without loop closing, against the truth.
struct MethodSample {
  RelativePoseError pieces;  ///< over pieces of kDriftPiece_m
  std::vector<Slip> slips;
  double ape_m = 0.0;    ///< RMSE of the positions after an SE(3) alignment
  double slam_ms = 0.0;  ///< mean per scan
};

/// One drive that every method of the table saw.
struct DriveSample {
  std::string drive;  ///< town, hills, ...
  std::uint64_t seed = 0;
  std::int64_t scans = 0;
  double path_m = 0.0;
  std::vector<MethodSample> methods;  ///< those of the table
};

/// Every method on the same drives.
struct TableSample {
  std::vector<TableMethod> methods;
  std::size_t against = 0;  ///< the method that the others are paired with
  std::vector<DriveSample> drives;
};

/// The sample of one drive. Nothing where a method is missing or too few of its poses have a true
/// pose.
std::optional<DriveSample> drive_sample(const DriveFigures& drive,
                                        const std::vector<TableMethod>& methods);
/// The names of the sample's drives, each once.
std::vector<std::string> drive_names(const TableSample& sample);
/// The part of the sample with the drives of one name.
TableSample of_drive(const TableSample& sample, const std::string& name);

/// One method over all drives, and beside the one that the table pairs with, drive by drive. Means
/// over drives, each drive counting alike, with intervals over drives; NaN where there is none.
struct MethodStatistics {
  std::string title;  ///< of the method
  bool is_paired_with = false;
  Estimate drift_percent;          ///< translation over pieces of kDriftPiece_m
  Estimate drift_deg_per_100m;     ///< rotation
  Estimate drift_percent_no_slip;  ///< over pieces that share no scan with a slip of the method
  std::size_t slips = 0;           ///< on all drives together
  Estimate slips_per_100_km;       ///< of the path of all drives together
  Estimate ape_m;
  double slam_ms = 0.0;
  /// Per drive the method's drift minus the other's, %, and their mean.
  std::vector<double> drift_differences_percent;
  Estimate drift_difference_percent;
  Estimate drift_ratio;          ///< mean of the method's over mean of the other's
  Estimate drift_ratio_no_slip;  ///< of the pieces on which neither of the two slips
  Estimate slips_difference;     ///< per 100 km
  /// Share of the gap between LiDAR-16's drift and LiDAR-64's that the method closes: 0 is
  /// LiDAR-16, 1 is LiDAR-64. Nothing where one of the two is not in the table.
  std::optional<Estimate> gap_closed;
  std::optional<Estimate> slip_gap_closed;  ///< share of the gap between their slips
};
MethodStatistics statistics_of(const TableSample& sample, std::size_t method);
/// The statistics of every method.
std::vector<MethodStatistics> statistics_of(const TableSample& sample);

/// The statistics of a part of a sample, for all drives "all".
struct PartStatistics {
  std::string name;
  TableSample sample;
  std::vector<MethodStatistics> methods;
};
/// All drives, then those of each kind.
std::vector<PartStatistics> parts_of(const TableSample& sample);

/// One figure of a method's statistics, in tables and in files.
struct StatisticsColumn {
  const char* column;
  const char* key;  ///< in files; nullptr: not as an estimate
  int decimals;     ///< in tables
  bool of_others;   ///< not of the method that the others are paired with
  std::function<std::optional<Estimate>(const MethodStatistics& method)> of;
};
const std::vector<StatisticsColumn>& summary_columns();
const std::vector<StatisticsColumn>& pair_columns();

}  // namespace hqslam::tools
