#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "table/result_sources_hash.h"
#include "table/table_report.h"

namespace hqslam::tools {
namespace {

/// "0.0391 [0.0350, 0.0432]"
std::string estimate_text(const Estimate& estimate, int decimals) {
  if (!std::isfinite(estimate.value)) return kNoFigure;
  std::string text = fmt::format("{:.{}f}", estimate.value, decimals);
  if (std::isfinite(estimate.low) && std::isfinite(estimate.high)) {
    text += fmt::format(" [{:.{}f}, {:.{}f}]", estimate.low, decimals, estimate.high, decimals);
  }
  return text;
}

/// A row per method.
TextTable table_of(const TableSample& sample, const std::string& title,
                   const std::vector<StatisticsColumn>& columns, const Estimates& estimates) {
  TextTable table{.title = title, .columns = {"Method"}};
  for (const StatisticsColumn& column : columns) table.columns.emplace_back(column.column);
  for (std::size_t method = 0; method < estimates.size(); ++method) {
    std::vector<std::string>& cells = table.rows.emplace_back();
    cells.push_back(sample.methods()[method].method.title);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const std::optional<Estimate>& estimate = estimates[method][i];
      const bool is_there = estimate && !(columns[i].of_others && method == sample.against);
      cells.push_back(is_there ? estimate_text(*estimate, columns[i].decimals) : kNoFigure);
    }
  }
  return table;
}

nlohmann::ordered_json paired_drifts_of(const PartStatistics& part) {
  nlohmann::ordered_json drifts = nlohmann::ordered_json::array();
  for (std::size_t method = 0; method < part.pairs.size(); ++method) {
    if (method == part.sample.against) continue;
    const Estimate& mean = *part.pairs[method].front();  // of the differences
    drifts.push_back({{"name", part.sample.methods()[method].method.title},
                      {"dots", drift_differences_percent(part.sample, method)},
                      {"mean", mean.value},
                      {"low", mean.low},
                      {"high", mean.high}});
  }
  return drifts;
}

/// "town: seeds 1, 2, 3; 1000 scans each, 2.7 km"
std::string sample_text(const TableSample& sample) {
  std::string text;
  for (const std::string& kind : kinds_of(sample)) {
    const TableSample part = of_kind(sample, kind);
    std::vector<std::uint64_t> seeds;
    double all_m = 0.0;
    for (const DriveFigures* drive : part.drives) {
      seeds.push_back(drive->seed);
      all_m += path_m(*drive);
    }
    text += fmt::format("{}{}: seeds {}; {} scans each, {:.1f} km in all", text.empty() ? "" : "; ",
                        kind, fmt::join(seeds, ", "), part.drives.front()->scans, 1e-3 * all_m);
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
    shown.paired_with = part.sample.methods()[part.sample.against].method.title;
    shown.tables = {
        table_of(part.sample, "Drift, slips and position error", summary_columns(), part.summary),
        table_of(part.sample, fmt::format("Drive by drive against {}", shown.paired_with),
                 pair_columns(), part.pairs)};
    shown.paired_drifts = paired_drifts_of(part);
  }
  report.notes = notes_of(sample);
  report.json = statistics_json(parts);
  return report;
}

}  // namespace hqslam::tools
