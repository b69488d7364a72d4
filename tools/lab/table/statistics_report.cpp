#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <limits>

#include "table/result_sources_hash.h"
#include "table/table_report.h"

namespace hqslam::tools {
namespace {

using Methods = std::vector<MethodStatistics>;

/// "0.0391 [0.0350, 0.0432]"
std::string estimate_text(const Estimate& estimate, int decimals) {
  if (!std::isfinite(estimate.value)) return kNoFigure;
  std::string text = fmt::format("{:.{}f}", estimate.value, decimals);
  if (std::isfinite(estimate.low) && std::isfinite(estimate.high)) {
    text += fmt::format(" [{:.{}f}, {:.{}f}]", estimate.low, decimals, estimate.high, decimals);
  }
  return text;
}

/// A figure without an interval.
template <typename Number>
Estimate number(Number value) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  return {static_cast<double>(value), kNone, kNone};
}

/// A row per method.
TextTable table_of(const Methods& methods, const std::string& title,
                   const std::vector<StatisticsColumn>& columns) {
  TextTable table{.title = title, .columns = {"Method"}};
  for (const StatisticsColumn& column : columns) table.columns.emplace_back(column.column);
  for (const MethodStatistics& method : methods) {
    std::vector<std::string>& cells = table.rows.emplace_back();
    cells.push_back(method.title);
    for (const StatisticsColumn& column : columns) {
      const std::optional<Estimate> estimate = column.of(method);
      const bool is_there = estimate && !(column.of_others && method.is_paired_with);
      cells.push_back(is_there ? estimate_text(*estimate, column.decimals) : kNoFigure);
    }
  }
  return table;
}

std::string paired_with(const Methods& methods) {
  for (const MethodStatistics& method : methods)
    if (method.is_paired_with) return method.title;
  return "";
}

std::vector<PairedDrift> paired_drifts_of(const Methods& methods) {
  std::vector<PairedDrift> drifts;
  for (const MethodStatistics& method : methods) {
    if (method.is_paired_with) continue;
    drifts.push_back(
        {method.title, method.drift_differences_percent, method.drift_difference_percent});
  }
  return drifts;
}

/// "town: seeds 1, 2, 3; 1000 scans each, 2.7 km"
std::string sample_text(const TableSample& sample) {
  std::string text;
  for (const std::string& name : drive_names(sample)) {
    std::vector<std::uint64_t> seeds;
    double path_m = 0.0;
    for (const DriveSample& drive : of_drive(sample, name).drives) {
      seeds.push_back(drive.seed);
      path_m += drive.path_m;
    }
    text += fmt::format("{}{}: seeds {}; {} scans each, {:.1f} km in all", text.empty() ? "" : "; ",
                        name, fmt::join(seeds, ", "), of_drive(sample, name).drives.front().scans,
                        1e-3 * path_m);
  }
  return text;
}

std::vector<std::string> notes_of(const TableSample& sample) {
  return {
      fmt::format(
          "Every method saw the same {} simulated drives, without loop closing; errors are against "
          "the truth. [ , ]: 95 % interval, bootstrap over drives (10,000 draws, percentiles). An "
          "interval of differences without 0, or of ratios without 1, is evidence of a difference.",
          sample.drives.size()),
      fmt::format("Drift: mean error of the motion over pieces of {:.0f} m, one from every scan, "
                  "as in KITTI's odometry benchmark; mean over drives.",
                  kDriftPiece_m),
      ("Slips: places where the motion over ten scans is wrong by more than 0.3 m or 0.3 degrees; "
       "successive scans are one slip. Drift where it does not slip: over pieces that share no "
       "scan "
       "with a slip."),
      ("Share of the gap closed: (LiDAR-16 - method) / (LiDAR-16 - LiDAR-64); 1 is as good as "
       "LiDAR-64. It is unreliable where the two hardly differ."),
      ("APE: absolute pose error, RMSE of the position after an SE(3) alignment. SLAM, ms: mean "
       "per scan with one thread, drives beside each other where there were several threads."),
      fmt::format("Made by build {} of the program.", result_sources_hash())};
}

}  // namespace

const std::vector<StatisticsColumn>& summary_columns() {
  using M = MethodStatistics;
  static const std::vector<StatisticsColumn> columns = {
      {"drift, %", "drift_percent", 4, false, &M::drift_percent},
      {"drift, deg/100 m", "drift_deg_per_100m", 4, false, &M::drift_deg_per_100m},
      {"drift where it does not slip, %", "drift_percent_no_slip", 4, false,
       &M::drift_percent_no_slip},
      {"slips", nullptr, 0, false, [](const M& m) { return number(m.slips); }},
      {"slips per 100 km", "slips_per_100_km", 0, false, &M::slips_per_100_km},
      {"APE, m", "ape_m", 3, false, &M::ape_m},
      {"SLAM, ms", nullptr, 1, false, [](const M& m) { return number(m.slam_ms); }}};
  return columns;
}

const std::vector<StatisticsColumn>& pair_columns() {
  using M = MethodStatistics;
  static const std::vector<StatisticsColumn> columns = {
      {"drift, difference in %", "drift_difference_percent", 4, true, &M::drift_difference_percent},
      {"drift, ratio", "drift_ratio", 2, true, &M::drift_ratio},
      {"ratio where neither slips", "drift_ratio_no_slip", 2, true, &M::drift_ratio_no_slip},
      {"slips per 100 km, difference", "slips_difference_per_100_km", 0, true,
       &M::slips_difference},
      {"share of LiDAR-16's gap to LiDAR-64 closed, drift", "gap_closed", 2, false, &M::gap_closed},
      {"slips", "slip_gap_closed", 2, false, &M::slip_gap_closed}};
  return columns;
}

std::vector<PartStatistics> parts_of(const TableSample& sample) {
  std::vector<PartStatistics> parts = {{"all", sample, statistics_of(sample)}};
  for (const std::string& name : drive_names(sample)) {
    TableSample part = of_drive(sample, name);
    parts.push_back({name, part, statistics_of(part)});
  }
  return parts;
}

TableReport statistics_report(const TableSample& sample) {
  TableReport report;
  report.title = "16 rows, 16 upsampled to 64, and 64 rows over many drives";
  const std::vector<PartStatistics> parts = parts_of(sample);
  const bool one_kind = parts.size() == 2;
  for (const PartStatistics& part : parts) {
    const bool all = &part == &parts.front();
    if (all && one_kind) continue;
    ReportPart& shown = report.parts.emplace_back(
        ReportPart{all ? "All drives" : part.name, sample_text(part.sample), {}});
    shown.tables = {
        table_of(part.methods, "Drift, slips and position error", summary_columns()),
        table_of(part.methods, fmt::format("Drive by drive against {}", paired_with(part.methods)),
                 pair_columns())};
    shown.paired_with = paired_with(part.methods);
    shown.paired_drifts = paired_drifts_of(part.methods);
  }
  report.notes = notes_of(sample);
  report.json = statistics_json(parts);
  return report;
}

}  // namespace hqslam::tools
