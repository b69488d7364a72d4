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

/// Of a drift that has pieces.
double translation_of(const Drift& drift) {
  return drift.pieces > 0 ? drift.translation_percent : kNone;
}

/// The values of a method, one per drive, as a function of sample and method. value: of a drive.
template <typename Value>
auto per_drive(const Value& value) {
  return [=](const TableSample& sample, std::size_t method) {
    std::vector<double> values;
    for (const DriveFigures* drive : sample.drives) values.push_back(value(*drive, method));
    return values;
  };
}

const auto drifts_percent = per_drive([](const DriveFigures& drive, std::size_t method) {
  return translation_of(drift(errors_of(drive, method).pieces));
});

const auto rotations_deg_per_100m = per_drive([](const DriveFigures& drive, std::size_t method) {
  const Drift all = drift(errors_of(drive, method).pieces);
  return all.pieces > 0 ? all.rotation_deg_per_100m : kNone;
});

const auto apes_m = per_drive([](const DriveFigures& drive, std::size_t method) {
  return errors_of(drive, method).ape_rmse_m();
});

const auto slip_counts = per_drive([](const DriveFigures& drive, std::size_t method) {
  return static_cast<double>(drive.methods[method].slips.size());
});

/// Over the pieces on which neither the method nor `other` slips.
std::vector<double> drifts_without_slips_percent(const TableSample& sample, std::size_t method,
                                                 std::size_t other) {
  return per_drive([=](const DriveFigures& drive, std::size_t) {
    std::vector<Slip> both = drive.methods[method].slips;
    both.insert(both.end(), drive.methods[other].slips.begin(), drive.methods[other].slips.end());
    return translation_of(drift(errors_of(drive, method).pieces, both));
  })(sample, method);
}

std::vector<double> minus(std::vector<double> values, const std::vector<double>& others) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] -= others[i];
  return values;
}

/// Sum over sum, of the drives that have both.
Estimate ratio(const std::vector<double>& numerators, const std::vector<double>& denominators) {
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

Estimate mean(const std::vector<double>& values) {
  return ratio(values, std::vector<double>(values.size(), 1.0));
}

/// Per 100 km of the path of all drives together.
Estimate per_100_km(const std::vector<double>& values, const TableSample& sample) {
  constexpr double kMetres = 100e3;
  std::vector<double> paths_m;
  for (const DriveFigures* drive : sample.drives) paths_m.push_back(path_m(*drive));
  const Estimate per_metre = ratio(values, paths_m);
  return {kMetres * per_metre.value, kMetres * per_metre.low, kMetres * per_metre.high};
}

/// A figure without an interval.
Estimate number(double value) { return {value, kNone, kNone}; }

std::optional<std::size_t> position_of(const TableSample& sample, const std::string& name) {
  const auto found =
      std::ranges::find(sample.methods(), name, [](const TableResult& m) { return m.method.name; });
  if (found == sample.methods().end()) return std::nullopt;
  return static_cast<std::size_t>(found - sample.methods().begin());
}

/// (LiDAR-16's - the method's) / (LiDAR-16's - LiDAR-64's), sums over drives: 0 is LiDAR-16, 1 is
/// LiDAR-64. Nothing where one of the two is not in the table.
template <typename PerDrive>
std::optional<Estimate> share_of_gap(const PerDrive& values, const TableSample& sample,
                                     std::size_t method) {
  const auto few = position_of(sample, table_methods().front().name);
  const auto all = position_of(sample, table_methods().back().name);
  if (!few || !all) return std::nullopt;
  const std::vector<double> of_few = values(sample, *few);
  return ratio(minus(of_few, values(sample, method)), minus(of_few, values(sample, *all)));
}

Estimates estimates_of(const TableSample& sample, const std::vector<StatisticsColumn>& columns) {
  Estimates estimates(sample.methods().size());
  for (std::size_t method = 0; method < estimates.size(); ++method) {
    for (const StatisticsColumn& column : columns) {
      estimates[method].push_back(column.of(sample, method));
    }
  }
  return estimates;
}

PartStatistics part_of(const std::string& name, const TableSample& sample) {
  return {name, sample, estimates_of(sample, summary_columns()),
          estimates_of(sample, pair_columns())};
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

TableSample sample_of(const std::vector<DriveFigures>& all, const TablePlan& plan) {
  TableSample sample{plan.against, {}};
  for (const DriveFigures& drive : all) {
    const auto has_errors = [](const TableResult& figures) {
      return figures.against_truth[kLoopClosingOff].has_value();
    };
    if (drive.methods.size() == plan.methods.size() &&
        std::ranges::all_of(drive.methods, has_errors)) {
      sample.drives.push_back(&drive);
    }
  }
  return sample;
}

const ErrorFigures& errors_of(const DriveFigures& drive, std::size_t method) {
  return *drive.methods[method].against_truth[kLoopClosingOff];
}

double path_m(const DriveFigures& drive) {
  return errors_of(drive, drive.methods.size() - 1).path_m;
}

std::vector<std::string> kinds_of(const TableSample& sample) {
  std::vector<std::string> kinds;
  for (const DriveFigures* drive : sample.drives) {
    if (std::ranges::find(kinds, drive->kind) == kinds.end()) kinds.push_back(drive->kind);
  }
  return kinds;
}

TableSample of_kind(const TableSample& sample, const std::string& kind) {
  TableSample part = sample;
  std::erase_if(part.drives, [&](const DriveFigures* drive) { return drive->kind != kind; });
  return part;
}

std::vector<double> drift_differences_percent(const TableSample& sample, std::size_t method) {
  return minus(drifts_percent(sample, method), drifts_percent(sample, sample.against));
}

std::size_t slips_of(const TableSample& sample, std::size_t method) {
  std::size_t slips = 0;
  for (const DriveFigures* drive : sample.drives) slips += drive->methods[method].slips.size();
  return slips;
}

double slam_ms_of(const TableSample& sample, std::size_t method) {
  double mean_ms = 0.0;
  for (const DriveFigures* drive : sample.drives) {
    mean_ms += drive->methods[method].slam_ms() / static_cast<double>(sample.drives.size());
  }
  return mean_ms;
}

const std::vector<StatisticsColumn>& summary_columns() {
  using S = TableSample;
  using Method = std::size_t;
  static const std::vector<StatisticsColumn> columns = {
      {"drift, %", "drift_percent", 4, false,
       [](const S& s, Method m) { return mean(drifts_percent(s, m)); }},
      {"drift, deg/100 m", "drift_deg_per_100m", 4, false,
       [](const S& s, Method m) { return mean(rotations_deg_per_100m(s, m)); }},
      {"drift where it does not slip, %", "drift_percent_no_slip", 4, false,
       [](const S& s, Method m) { return mean(drifts_without_slips_percent(s, m, m)); }},
      {"slips", nullptr, 0, false,
       [](const S& s, Method m) { return number(static_cast<double>(slips_of(s, m))); }},
      {"slips per 100 km", "slips_per_100_km", 0, false,
       [](const S& s, Method m) { return per_100_km(slip_counts(s, m), s); }},
      {"APE, m", "ape_m", 3, false, [](const S& s, Method m) { return mean(apes_m(s, m)); }},
      {"SLAM, ms", nullptr, 1, false,
       [](const S& s, Method m) { return number(slam_ms_of(s, m)); }}};
  return columns;
}

const std::vector<StatisticsColumn>& pair_columns() {
  using S = TableSample;
  using Method = std::size_t;
  static const std::vector<StatisticsColumn> columns = {
      {"drift, difference in %", "drift_difference_percent", 4, true,
       [](const S& s, Method m) { return mean(drift_differences_percent(s, m)); }},
      {"drift, ratio", "drift_ratio", 2, true,
       [](const S& s, Method m) {
         return ratio(drifts_percent(s, m), drifts_percent(s, s.against));
       }},
      {"ratio where neither slips", "drift_ratio_no_slip", 2, true,
       [](const S& s, Method m) {
         return ratio(drifts_without_slips_percent(s, m, s.against),
                      drifts_without_slips_percent(s, s.against, m));
       }},
      {"slips per 100 km, difference", "slips_difference_per_100_km", 0, true,
       [](const S& s, Method m) {
         return per_100_km(minus(slip_counts(s, m), slip_counts(s, s.against)), s);
       }},
      {"share of LiDAR-16's gap to LiDAR-64 closed, drift", "gap_closed", 2, false,
       [](const S& s, Method m) { return share_of_gap(drifts_percent, s, m); }},
      {"slips", "slip_gap_closed", 2, false,
       [](const S& s, Method m) { return share_of_gap(slip_counts, s, m); }}};
  return columns;
}

std::vector<PartStatistics> parts_of(const TableSample& sample) {
  std::vector<PartStatistics> parts = {part_of("all", sample)};
  for (const std::string& kind : kinds_of(sample)) {
    parts.push_back(part_of(kind, of_kind(sample, kind)));
  }
  return parts;
}

}  // namespace hqslam::tools
