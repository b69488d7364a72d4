#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string_view>

#include "files/content_hash.h"
#include "report/chart.h"
#include "table/result_sources_hash.h"
#include "table/table_report.h"

namespace hqslam::tools {
namespace {

using Methods = std::vector<MethodStatistics>;

constexpr std::string_view kStyle = R"css(
.pairs { margin-left: min(14rem, 40vw); }
.pairs .zero { stroke: var(--text); stroke-width: 1.5px; }
.pairs .interval { stroke: var(--estimate); stroke-width: 4px; stroke-linecap: round; }
.pairs .dot {
  position: absolute; width: .45rem; height: .45rem; border-radius: 50%;
  transform: translate(-50%, -50%); background: var(--quiet); opacity: .55;
}
.pairs .mean {
  position: absolute; width: .8rem; height: .8rem; border-radius: 50%;
  transform: translate(-50%, -50%); background: var(--estimate);
}
.pairs .y.tick { color: var(--text); font-size: .85rem; }
)css";

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

/// Wide enough for the intervals and for nine tenths of the dots: a drive on which one method was
/// lost would press all else together.
PlotBox box_of(const Methods& methods) {
  std::vector<double> sizes;
  double widest = 0.0;
  for (const MethodStatistics& method : methods) {
    for (const double value : method.drift_differences_percent) {
      if (std::isfinite(value)) sizes.push_back(std::abs(value));
    }
  }
  std::ranges::sort(sizes);
  if (!sizes.empty()) widest = sizes[(sizes.size() - 1) * 9 / 10];
  for (const MethodStatistics& method : methods) {
    for (const double value :
         {method.drift_difference_percent.value, method.drift_difference_percent.low,
          method.drift_difference_percent.high}) {
      if (std::isfinite(value)) widest = std::max(widest, std::min(std::abs(value), 4.0 * widest));
    }
  }
  widest = widest > 0.0 ? 1.1 * widest : 1.0;
  return {-widest, widest, 0.0, static_cast<double>(methods.size())};
}

std::string mark_html(const PlotBox& box, const char* kind, double x, double y) {
  if (!std::isfinite(x)) return "";
  const double inside = std::clamp(x, box.x_min, box.x_max);
  return fmt::format("<span class=\"{}\" style=\"left:{:.2f}%;top:{:.2f}%\"></span>", kind,
                     100.0 * to_plot_x(box, inside) / kPlotUnits,
                     100.0 * to_plot_y(box, y) / kPlotUnits);
}

std::string row_svg(const PlotBox& box, const MethodStatistics& method, double y) {
  if (!std::isfinite(method.drift_difference_percent.low)) return "";
  return fmt::format(
      "<path class=\"interval\" d=\"M{:.1f},{:.1f}H{:.1f}\"/>\n",
      to_plot_x(box, std::clamp(method.drift_difference_percent.low, box.x_min, box.x_max)),
      to_plot_y(box, y),
      to_plot_x(box, std::clamp(method.drift_difference_percent.high, box.x_min, box.x_max)));
}

std::string row_html(const PlotBox& box, const MethodStatistics& method, double y) {
  std::string html = fmt::format("<span class=\"y tick\" style=\"top:{:.2f}%\">{}</span>",
                                 100.0 * to_plot_y(box, y) / kPlotUnits, escape_html(method.title));
  for (const double value : method.drift_differences_percent)
    html += mark_html(box, "dot", value, y);
  return html + mark_html(box, "mean", method.drift_difference_percent.value, y);
}

/// Drift beside that of the method that the others are paired with.
std::string pairs_html(const Methods& all) {
  Methods methods;
  std::ranges::copy_if(all, std::back_inserter(methods),
                       [](const MethodStatistics& method) { return !method.is_paired_with; });
  if (methods.empty()) return "";
  const PlotBox box = box_of(methods);
  const PlotGrid grid =
      plot_grid(box, ticks_within(box.x_min, box.x_max, tick_step(box.x_max - box.x_min, 6)), {});
  std::string svg =
      fmt::format("<path class=\"zero\" d=\"M{0:.1f},0V{1}\"/>\n", to_plot_x(box, 0.0), kPlotUnits);
  std::string marks;
  for (std::size_t i = 0; i < methods.size(); ++i) {
    const double y = static_cast<double>(methods.size() - i) - 0.5;
    svg += row_svg(box, methods[i], y);
    marks += row_html(box, methods[i], y);
  }
  return fmt::format(
      "<h3>Drift beside {0}'s</h3>\n<p class=\"quiet\">Small dots: one drive each, what lies "
      "outside stands at the edge. Large dot and bar: mean and its 95 % interval. Left of the line "
      "is better.</p>\n<div class=\"plot pairs\" style=\"height:{1:.1f}rem\"><svg "
      "viewBox=\"0 0 1000 1000\" preserveAspectRatio=\"none\" role=\"img\" aria-label=\"Drift "
      "minus {0}'s\">\n{2}{3}</svg>{4}{5}</div>\n<p class=\"axis below\">drift minus {0}'s, % of "
      "the path</p>\n",
      escape_html(paired_with(all)), 2.2 * static_cast<double>(methods.size()), grid.svg, svg,
      grid.labels_html, marks);
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
          "interval of differences that leaves out 0, or of ratios that leaves out 1, speaks for a "
          "difference.",
          sample.drives.size()),
      fmt::format("Drift: mean error of the motion over pieces of {:.0f} m, one from every scan, "
                  "as in KITTI's odometry benchmark; mean over drives.",
                  kDriftPiece_m),
      ("Slips: places where the motion over ten scans is wrong by more than 0.3 m or 0.3 degrees; "
       "scans that follow one another are one slip. Where it does not slip: pieces that share no "
       "scan with a slip."),
      ("Share of the gap closed: (LiDAR-16 - method) / (LiDAR-16 - LiDAR-64); 1 is as good as "
       "LiDAR-64. It means little where the two hardly differ."),
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
    shown.figures_html = pairs_html(part.methods);
  }
  report.notes = notes_of(sample);
  report.style = kStyle;
  report.json = statistics_json(parts);
  return report;
}

}  // namespace hqslam::tools
