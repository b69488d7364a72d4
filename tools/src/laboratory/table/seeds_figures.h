#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/evaluation/drift.h"
#include "laboratory/table/bootstrap.h"
#include "laboratory/table/table_plan.h"
#include "laboratory/table/table_result.h"

namespace hqslam::tools {

/// One method on one drive, against the truth.
struct SeedRun {
  RelativePoseError pieces;  ///< over pieces of kDriftPiece_m
  std::vector<Slip> slips;
  double ape_m = 0.0;    ///< RMSE of the positions after an SE(3) alignment
  double slam_ms = 0.0;  ///< mean per scan
};

/// One drive that every method of the table saw.
struct SeedDrive {
  std::string drive;  ///< town, hills, ...
  std::uint64_t seed = 0;
  std::int64_t scans = 0;
  double path_m = 0.0;
  std::vector<SeedRun> runs;  ///< one per method of the table
};

/// Every method on the same drives.
struct SeedTable {
  std::vector<TableMethod> methods;
  std::size_t against = 0;  ///< the method that the others are paired with
  std::vector<SeedDrive> drives;
};

/// One drive from its results, one per method, without loop closing. Nothing if fewer than 3 poses
/// of one of them have a partner in the truth. Throws Error.
std::optional<SeedDrive> seed_drive(const TableDrive& drive,
                                    const std::vector<TableResult>& results,
                                    const Trajectory& truth);

/// The names of the table's drives, each once.
std::vector<std::string> drive_names(const SeedTable& table);
/// The drives of one name alone.
SeedTable of_drive(const SeedTable& table, const std::string& name);

/// One method over all drives. Means over drives, each drive counting alike, with intervals over
/// drives.
struct SeedSummary {
  Estimate drift_percent;          ///< translation over pieces of kDriftPiece_m
  Estimate drift_deg_per_100m;     ///< rotation
  Estimate drift_percent_no_slip;  ///< over pieces that share no scan with a slip of the method
  std::size_t slips = 0;           ///< on all drives together
  Estimate slips_per_100_km;       ///< of the path of all drives together
  Estimate ape_m;
  double slam_ms = 0.0;
};
SeedSummary summary_of(const SeedTable& table, std::size_t method);

/// One method beside the one that the table pairs with, drive by drive; NaN where there is none.
struct SeedPair {
  Estimate drift_difference_percent;  ///< mean over drives of the method's minus the other's
  Estimate drift_ratio;               ///< mean of the method's over mean of the other's
  Estimate drift_ratio_no_slip;       ///< of the pieces on which neither of the two slips
  Estimate slips_difference;          ///< per 100 km
  /// Share of the gap between LiDAR-16's drift and LiDAR-64's that the method closes: 0 is
  /// LiDAR-16, 1 is LiDAR-64. Nothing where one of the two is not in the table.
  std::optional<Estimate> gap_closed;
  std::optional<Estimate> slip_gap_closed;  ///< the same of slips
};
SeedPair pair_of(const SeedTable& table, std::size_t method);

/// Per drive the method's drift minus the other's, %.
std::vector<double> drift_differences_percent(const SeedTable& table, std::size_t method);

}  // namespace hqslam::tools
