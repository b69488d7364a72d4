#include "table/table_statistics.h"

#include <algorithm>
#include <cmath>

namespace hqslam::tools {
namespace {

/// The values of a method, one per drive, as a function of sample and method. value: of a drive.
template <typename Value>
auto per_drive(const Value& value) {
  return [=](const TableSample& sample, std::size_t method) {
    std::vector<double> values;
    for (const DriveErrors& drive : sample.drives) values.push_back(value(drive, method));
    return values;
  };
}

/// A figure of the drift where a drive has pieces.
double drift_of(const TrajectoryErrors& errors, double Drift::*figure,
                const std::vector<Slip>& left_out = {}) {
  const Drift all = drift(errors.pieces, left_out);
  return all.pieces > 0 ? all.*figure : kNoEstimate;
}

const auto drifts_percent = per_drive([](const DriveErrors& drive, std::size_t method) {
  return drift_of(drive.methods[method], &Drift::translation_percent);
});

const auto apes_m = per_drive(
    [](const DriveErrors& drive, std::size_t method) { return drive.methods[method].ape_rmse_m; });

const auto slip_counts = per_drive([](const DriveErrors& drive, std::size_t method) {
  return static_cast<double>(drive.methods[method].slips.size());
});

/// Over the pieces on which neither the method nor `other` slips.
std::vector<double> drifts_without_slips_percent(const TableSample& sample, std::size_t method,
                                                 std::size_t other) {
  return per_drive([=](const DriveErrors& drive, std::size_t) {
    const TrajectoryErrors& errors = drive.methods[method];
    std::vector<Slip> both = errors.slips;
    both.insert(both.end(), drive.methods[other].slips.begin(), drive.methods[other].slips.end());
    return drift_of(errors, &Drift::translation_percent, both);
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
    return denominator > 0.0 ? numerator / denominator : kNoEstimate;
  });
}

Estimate mean(const std::vector<double>& values) {
  return ratio(values, std::vector<double>(values.size(), 1.0));
}

/// (LiDAR-16's - the method's) / (LiDAR-16's - LiDAR-64's), sums of drift over drives: 0 is
/// LiDAR-16, 1 is LiDAR-64. None where one of the two is not in the table.
Estimate gap_closed(const TableSample& sample, std::size_t method) {
  const auto drifts_of = [&](const char* name) -> std::optional<std::vector<double>> {
    const auto found = std::ranges::find(sample.methods, name, &TableMethod::name);
    if (found == sample.methods.end()) return std::nullopt;
    return drifts_percent(sample, static_cast<std::size_t>(found - sample.methods.begin()));
  };
  const auto few = drifts_of(kFewRows);
  const auto all = drifts_of(kAllRows);
  if (!few || !all) return {kNoEstimate, kNoEstimate, kNoEstimate};
  return ratio(minus(*few, drifts_percent(sample, method)), minus(*few, *all));
}

double sum_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum;
}

}  // namespace

std::vector<std::string> kinds_of(const TableSample& sample) {
  std::vector<std::string> kinds;
  for (const DriveErrors& drive : sample.drives) {
    if (std::ranges::find(kinds, drive.kind) == kinds.end()) kinds.push_back(drive.kind);
  }
  return kinds;
}

TableSample of_kind(const TableSample& sample, const std::string& kind) {
  TableSample part = sample;
  std::erase_if(part.drives, [&](const DriveErrors& drive) { return drive.kind != kind; });
  return part;
}

std::vector<double> drift_differences_percent(const TableSample& sample, std::size_t method) {
  return minus(drifts_percent(sample, method), drifts_percent(sample, sample.against));
}

const std::vector<StatisticsColumn>& summary_columns() {
  using S = TableSample;
  using Method = std::size_t;
  static const std::vector<StatisticsColumn> columns = {
      {"drift, %", "drift_percent", 4, false,
       [](const S& s, Method m) { return mean(drifts_percent(s, m)); }},
      {"drift where it does not slip, %", "drift_percent_no_slip", 4, false,
       [](const S& s, Method m) { return mean(drifts_without_slips_percent(s, m, m)); }},
      {"slips", "slips", 0, false,
       [](const S& s, Method m) {
         return Estimate{sum_of(slip_counts(s, m)), kNoEstimate, kNoEstimate};
       }},
      {"APE, m", "ape_m", 3, false, [](const S& s, Method m) { return mean(apes_m(s, m)); }}};
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
      {"share of LiDAR-16's gap to LiDAR-64 closed", "gap_closed", 2, false, gap_closed}};
  return columns;
}

}  // namespace hqslam::tools
