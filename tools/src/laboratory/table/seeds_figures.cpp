#include "laboratory/table/seeds_figures.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hqslam/evaluation/trajectory_error.h"

namespace hqslam::tools {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kFewestPairs = 3;
constexpr double kMaxStampDifference_s = 0.02;

SeedRun run_of(const TableResult& result, const Trajectory& truth) {
  const Trajectory& estimate = result.trajectory[kLoopClosingOff];
  SeedRun run;
  run.pieces = relative_pose_error(estimate, truth, kDriftPiece_m, kMaxStampDifference_s);
  run.slips = slips(estimate, truth, {}, kMaxStampDifference_s);
  run.ape_m = absolute_pose_error(estimate, truth, Alignment::kSe3, kMaxStampDifference_s)
                  .translation_statistics.rmse;
  run.slam_ms =
      1e3 * result.timings.slam[kLoopClosingOff].total_s / static_cast<double>(estimate.size());
  return run;
}

/// Translation or rotation of a drift that has pieces.
double translation_of(const Drift& drift) {
  return drift.pieces > 0 ? drift.translation_percent : kNone;
}
double rotation_of(const Drift& drift) {
  return drift.pieces > 0 ? drift.rotation_deg_per_100m : kNone;
}

/// A value per drive.
template <typename Value>
std::vector<double> per_drive(const SeedTable& table, const Value& value) {
  std::vector<double> values;
  for (const SeedDrive& drive : table.drives) values.push_back(value(drive));
  return values;
}

std::vector<double> drifts_percent(const SeedTable& table, std::size_t method) {
  return per_drive(table, [&](const SeedDrive& drive) {
    return translation_of(drift(drive.runs[method].pieces));
  });
}

/// Over the pieces on which neither the method nor `other` slips.
std::vector<double> drifts_without_slips_percent(const SeedTable& table, std::size_t method,
                                                 std::size_t other) {
  return per_drive(table, [&](const SeedDrive& drive) {
    std::vector<Slip> both = drive.runs[method].slips;
    both.insert(both.end(), drive.runs[other].slips.begin(), drive.runs[other].slips.end());
    return translation_of(drift(drive.runs[method].pieces, both));
  });
}

std::vector<double> slip_counts(const SeedTable& table, std::size_t method) {
  return per_drive(table, [&](const SeedDrive& drive) {
    return static_cast<double>(drive.runs[method].slips.size());
  });
}

std::vector<double> paths_m(const SeedTable& table) {
  return per_drive(table, [](const SeedDrive& drive) { return drive.path_m; });
}

Estimate mean_over_drives(const std::vector<double>& values) {
  return bootstrap(values.size(), [&](const std::vector<std::size_t>& members) {
    double sum = 0.0;
    double count = 0.0;
    for (const std::size_t member : members) {
      if (!std::isfinite(values[member])) continue;
      sum += values[member];
      count += 1.0;
    }
    return count > 0.0 ? sum / count : kNone;
  });
}

/// Of the drives that have both.
Estimate ratio_over_drives(const std::vector<double>& numerators,
                           const std::vector<double>& denominators) {
  return bootstrap(numerators.size(), [&](const std::vector<std::size_t>& members) {
    double numerator = 0.0;
    double denominator = 0.0;
    for (const std::size_t member : members) {
      if (!std::isfinite(numerators[member]) || !std::isfinite(denominators[member])) continue;
      numerator += numerators[member];
      denominator += denominators[member];
    }
    return denominator > 0.0 ? numerator / denominator : kNone;
  });
}

std::vector<double> minus(std::vector<double> values, const std::vector<double>& others) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] -= others[i];
  return values;
}

Estimate per_100_km(Estimate per_metre) {
  constexpr double kMetres = 100e3;
  return {kMetres * per_metre.value, kMetres * per_metre.low, kMetres * per_metre.high};
}

std::optional<std::size_t> position_of(const SeedTable& table, const std::string& name) {
  for (std::size_t i = 0; i < table.methods.size(); ++i) {
    if (table.methods[i].name == name) return i;
  }
  return std::nullopt;
}

/// (LiDAR-16's - the method's) / (LiDAR-16's - LiDAR-64's), sums over drives.
template <typename PerDrive>
std::optional<Estimate> share_of_gap(const SeedTable& table, std::size_t method,
                                     const PerDrive& values) {
  const auto few = position_of(table, table_methods().front().name);
  const auto all = position_of(table, table_methods().back().name);
  if (!few || !all) return std::nullopt;
  const std::vector<double> of_few = values(table, *few);
  return ratio_over_drives(minus(of_few, values(table, method)),
                           minus(of_few, values(table, *all)));
}

}  // namespace

std::optional<SeedDrive> seed_drive(const TableDrive& drive,
                                    const std::vector<TableResult>& results,
                                    const Trajectory& truth) {
  SeedDrive seed{drive.simulated->name, drive.simulated->seed, 0, 0.0, {}};
  for (const TableResult& result : results) {
    const Trajectory& estimate = result.trajectory[kLoopClosingOff];
    const PosePairs pairs = associate(estimate, truth, kMaxStampDifference_s);
    if (pairs.estimate.size() < kFewestPairs) return std::nullopt;
    seed.scans = result.settings.scans;
    // The truth may be of a longer drive.
    const Trajectory of_scans(
        truth.begin(), truth.begin() + static_cast<std::ptrdiff_t>(pairs.reference.back()) + 1);
    seed.path_m = path_length_m(of_scans);
    seed.runs.push_back(run_of(result, of_scans));
  }
  return seed;
}

std::vector<std::string> drive_names(const SeedTable& table) {
  std::vector<std::string> names;
  for (const SeedDrive& drive : table.drives) {
    if (std::find(names.begin(), names.end(), drive.drive) == names.end()) {
      names.push_back(drive.drive);
    }
  }
  return names;
}

SeedTable of_drive(const SeedTable& table, const std::string& name) {
  SeedTable part{table.methods, table.against, {}};
  std::copy_if(table.drives.begin(), table.drives.end(), std::back_inserter(part.drives),
               [&](const SeedDrive& drive) { return drive.drive == name; });
  return part;
}

SeedSummary summary_of(const SeedTable& table, std::size_t method) {
  SeedSummary summary;
  summary.drift_percent = mean_over_drives(drifts_percent(table, method));
  summary.drift_deg_per_100m = mean_over_drives(per_drive(table, [&](const SeedDrive& drive) {
    return rotation_of(drift(drive.runs[method].pieces));
  }));
  summary.drift_percent_no_slip =
      mean_over_drives(drifts_without_slips_percent(table, method, method));
  for (const SeedDrive& drive : table.drives) {
    summary.slips += drive.runs[method].slips.size();
    summary.slam_ms += drive.runs[method].slam_ms / static_cast<double>(table.drives.size());
  }
  summary.slips_per_100_km =
      per_100_km(ratio_over_drives(slip_counts(table, method), paths_m(table)));
  summary.ape_m = mean_over_drives(
      per_drive(table, [&](const SeedDrive& drive) { return drive.runs[method].ape_m; }));
  return summary;
}

SeedPair pair_of(const SeedTable& table, std::size_t method) {
  const std::size_t other = table.against;
  SeedPair pair;
  pair.drift_difference_percent = mean_over_drives(drift_differences_percent(table, method));
  pair.drift_ratio = ratio_over_drives(drifts_percent(table, method), drifts_percent(table, other));
  pair.drift_ratio_no_slip = ratio_over_drives(drifts_without_slips_percent(table, method, other),
                                               drifts_without_slips_percent(table, other, method));
  pair.slips_difference = per_100_km(ratio_over_drives(
      minus(slip_counts(table, method), slip_counts(table, other)), paths_m(table)));
  pair.gap_closed = share_of_gap(table, method, drifts_percent);
  pair.slip_gap_closed = share_of_gap(table, method, slip_counts);
  return pair;
}

std::vector<double> drift_differences_percent(const SeedTable& table, std::size_t method) {
  return minus(drifts_percent(table, method), drifts_percent(table, table.against));
}

}  // namespace hqslam::tools
