#include "table/table_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace hqslam::tools {

namespace {

constexpr std::size_t kResamples = 10000;
constexpr double kBelow = 0.025;
constexpr std::uint64_t kSeed = 20251122;

/// The value below which a share of the sorted values lies, between the two next to it.
double percentile(const std::vector<double>& sorted, double share) {
  const double position = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  const double t = position - static_cast<double>(below);
  return (1.0 - t) * sorted[below] + t * sorted[above];
}

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Translation or rotation of a drift that has pieces.
double translation_of(const Drift& drift) {
  return drift.pieces > 0 ? drift.translation_percent : kNone;
}
double rotation_of(const Drift& drift) {
  return drift.pieces > 0 ? drift.rotation_deg_per_100m : kNone;
}

/// A value per drive.
template <typename Value>
std::vector<double> per_drive(const TableSample& sample, const Value& value) {
  std::vector<double> values;
  for (const DriveSample& drive : sample.drives) values.push_back(value(drive));
  return values;
}

std::vector<double> drifts_percent(const TableSample& sample, std::size_t method) {
  return per_drive(sample, [&](const DriveSample& drive) {
    return translation_of(drift(drive.methods[method].pieces));
  });
}

/// Over the pieces on which neither the method nor `other` slips.
std::vector<double> drifts_without_slips_percent(const TableSample& sample, std::size_t method,
                                                 std::size_t other) {
  return per_drive(sample, [&](const DriveSample& drive) {
    std::vector<Slip> both = drive.methods[method].slips;
    both.insert(both.end(), drive.methods[other].slips.begin(), drive.methods[other].slips.end());
    return translation_of(drift(drive.methods[method].pieces, both));
  });
}

std::vector<double> slip_counts(const TableSample& sample, std::size_t method) {
  return per_drive(sample, [&](const DriveSample& drive) {
    return static_cast<double>(drive.methods[method].slips.size());
  });
}

std::vector<double> paths_m(const TableSample& sample) {
  return per_drive(sample, [](const DriveSample& drive) { return drive.path_m; });
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

std::optional<std::size_t> position_of(const TableSample& sample, const std::string& name) {
  for (std::size_t i = 0; i < sample.methods.size(); ++i) {
    if (sample.methods[i].name == name) return i;
  }
  return std::nullopt;
}

/// (LiDAR-16's - the method's) / (LiDAR-16's - LiDAR-64's), sums over drives.
template <typename PerDrive>
std::optional<Estimate> share_of_gap(const TableSample& sample, std::size_t method,
                                     const PerDrive& values) {
  const auto few = position_of(sample, table_methods().front().name);
  const auto all = position_of(sample, table_methods().back().name);
  if (!few || !all) return std::nullopt;
  const std::vector<double> of_few = values(sample, *few);
  return ratio_over_drives(minus(of_few, values(sample, method)),
                           minus(of_few, values(sample, *all)));
}

}  // namespace

Estimate bootstrap(std::size_t n, const SampleFigure& figure) {
  std::vector<std::size_t> members(n);
  std::iota(members.begin(), members.end(), std::size_t{0});
  Estimate estimate{figure(members), kNone, kNone};
  if (n < 2) return estimate;
  std::mt19937_64 random(kSeed);
  std::vector<double> figures;
  for (std::size_t i = 0; i < kResamples; ++i) {
    for (std::size_t& member : members) member = static_cast<std::size_t>(random() % n);
    const double value = figure(members);
    if (std::isfinite(value)) figures.push_back(value);
  }
  if (figures.size() < kResamples / 2) return estimate;
  std::ranges::sort(figures);
  estimate.low = percentile(figures, kBelow);
  estimate.high = percentile(figures, 1.0 - kBelow);
  return estimate;
}

std::optional<DriveSample> drive_sample(const DriveFigures& drive,
                                        const std::vector<TableMethod>& methods) {
  DriveSample sample{drive.kind, drive.seed, drive.scans, 0.0, {}};
  for (const TableMethod& method : methods) {
    const MethodFigures* figures = find_method(drive, method.name);
    if (figures == nullptr || !figures->against_truth[kLoopClosingOff]) return std::nullopt;
    const ErrorFigures& error = *figures->against_truth[kLoopClosingOff];
    const TableResult& result = figures->result;
    sample.path_m = error.path_m;
    sample.methods.push_back({error.pieces, figures->slips, error.ape_rmse_m(),
                              1e3 * result.timings.slam[kLoopClosingOff].total_s /
                                  static_cast<double>(result.trajectory[kLoopClosingOff].size())});
  }
  return sample;
}

std::vector<std::string> drive_names(const TableSample& sample) {
  std::vector<std::string> names;
  for (const DriveSample& drive : sample.drives) {
    if (std::ranges::find(names, drive.drive) == names.end()) {
      names.push_back(drive.drive);
    }
  }
  return names;
}

TableSample of_drive(const TableSample& sample, const std::string& name) {
  TableSample part{sample.methods, sample.against, {}};
  std::ranges::copy_if(sample.drives, std::back_inserter(part.drives),
                       [&](const DriveSample& drive) { return drive.drive == name; });
  return part;
}

MethodStatistics statistics_of(const TableSample& sample, std::size_t method) {
  const std::size_t other = sample.against;
  MethodStatistics s;
  s.title = sample.methods[method].title;
  s.is_paired_with = method == other;
  const std::vector<double> drifts = drifts_percent(sample, method);
  const std::vector<double> other_drifts = drifts_percent(sample, other);
  s.drift_percent = mean_over_drives(drifts);
  s.drift_deg_per_100m = mean_over_drives(per_drive(sample, [&](const DriveSample& drive) {
    return rotation_of(drift(drive.methods[method].pieces));
  }));
  s.drift_percent_no_slip = mean_over_drives(drifts_without_slips_percent(sample, method, method));
  for (const DriveSample& drive : sample.drives) {
    s.slips += drive.methods[method].slips.size();
    s.slam_ms += drive.methods[method].slam_ms / static_cast<double>(sample.drives.size());
  }
  const std::vector<double> slips = slip_counts(sample, method);
  s.slips_per_100_km = per_100_km(ratio_over_drives(slips, paths_m(sample)));
  s.ape_m = mean_over_drives(
      per_drive(sample, [&](const DriveSample& drive) { return drive.methods[method].ape_m; }));
  s.drift_differences_percent = minus(drifts, other_drifts);
  s.drift_difference_percent = mean_over_drives(s.drift_differences_percent);
  s.drift_ratio = ratio_over_drives(drifts, other_drifts);
  s.drift_ratio_no_slip = ratio_over_drives(drifts_without_slips_percent(sample, method, other),
                                            drifts_without_slips_percent(sample, other, method));
  s.slips_difference =
      per_100_km(ratio_over_drives(minus(slips, slip_counts(sample, other)), paths_m(sample)));
  s.gap_closed = share_of_gap(sample, method, drifts_percent);
  s.slip_gap_closed = share_of_gap(sample, method, slip_counts);
  return s;
}

std::vector<MethodStatistics> statistics_of(const TableSample& sample) {
  std::vector<MethodStatistics> all;
  for (std::size_t i = 0; i < sample.methods.size(); ++i) all.push_back(statistics_of(sample, i));
  return all;
}

}  // namespace hqslam::tools
