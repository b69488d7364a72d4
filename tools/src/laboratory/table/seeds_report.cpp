#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "laboratory/table/table_output.h"
#include "report/chart.h"

namespace hqslam::tools {
namespace {

constexpr std::string_view kSeedsStyle = R"css(
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

/// One method of the plot.
struct PairRow {
  std::string title;
  std::vector<double> differences;  ///< per drive
  Estimate mean;
};

std::vector<PairRow> pair_rows(const SeedTable& table) {
  std::vector<PairRow> rows;
  for (std::size_t i = 0; i < table.methods.size(); ++i) {
    if (i == table.against) continue;
    rows.push_back({table.methods[i].title, drift_differences_percent(table, i),
                    pair_of(table, i).drift_difference_percent});
  }
  return rows;
}

/// Wide enough for the intervals and for nine tenths of the dots: a drive on which one method was
/// lost would press all else together.
PlotBox box_of(const std::vector<PairRow>& rows) {
  std::vector<double> sizes;
  double widest = 0.0;
  for (const PairRow& row : rows) {
    for (const double value : row.differences) {
      if (std::isfinite(value)) sizes.push_back(std::abs(value));
    }
  }
  std::sort(sizes.begin(), sizes.end());
  if (!sizes.empty()) widest = sizes[(sizes.size() - 1) * 9 / 10];
  for (const PairRow& row : rows) {
    for (const double value : {row.mean.value, row.mean.low, row.mean.high}) {
      if (std::isfinite(value)) widest = std::max(widest, std::min(std::abs(value), 4.0 * widest));
    }
  }
  widest = widest > 0.0 ? 1.1 * widest : 1.0;
  return {-widest, widest, 0.0, static_cast<double>(rows.size())};
}

std::string mark_html(const PlotBox& box, const char* kind, double x, double y) {
  if (!std::isfinite(x)) return "";
  const double inside = std::clamp(x, box.x_min, box.x_max);
  return fmt::format("<span class=\"{}\" style=\"left:{:.2f}%;top:{:.2f}%\"></span>", kind,
                     100.0 * to_plot_x(box, inside) / kPlotUnits,
                     100.0 * to_plot_y(box, y) / kPlotUnits);
}

std::string row_svg(const PlotBox& box, const PairRow& row, double y) {
  if (!std::isfinite(row.mean.low)) return "";
  return fmt::format("<path class=\"interval\" d=\"M{:.1f},{:.1f}H{:.1f}\"/>\n",
                     to_plot_x(box, std::clamp(row.mean.low, box.x_min, box.x_max)),
                     to_plot_y(box, y),
                     to_plot_x(box, std::clamp(row.mean.high, box.x_min, box.x_max)));
}

std::string row_html(const PlotBox& box, const PairRow& row, double y) {
  std::string html = fmt::format("<span class=\"y tick\" style=\"top:{:.2f}%\">{}</span>",
                                 100.0 * to_plot_y(box, y) / kPlotUnits, escape_html(row.title));
  for (const double value : row.differences) html += mark_html(box, "dot", value, y);
  return html + mark_html(box, "mean", row.mean.value, y);
}

std::string pairs_html(const SeedTable& table) {
  const std::vector<PairRow> rows = pair_rows(table);
  if (rows.empty()) return "";
  const PlotBox box = box_of(rows);
  const PlotGrid grid =
      plot_grid(box, ticks_within(box.x_min, box.x_max, tick_step(box.x_max - box.x_min, 6)), {});
  std::string svg =
      fmt::format("<path class=\"zero\" d=\"M{0:.1f},0V{1}\"/>\n", to_plot_x(box, 0.0), kPlotUnits);
  std::string marks;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double y = static_cast<double>(rows.size() - i) - 0.5;
    svg += row_svg(box, rows[i], y);
    marks += row_html(box, rows[i], y);
  }
  return fmt::format(
      "<h3>Drift beside {0}'s</h3>\n<p class=\"quiet\">Small dots: one drive each, what lies "
      "outside stands at the edge. Large dot and bar: mean and its 95 % interval. Left of the line "
      "is better.</p>\n<div class=\"plot pairs\" style=\"height:{1:.1f}rem\"><svg "
      "viewBox=\"0 0 1000 1000\" preserveAspectRatio=\"none\" role=\"img\" aria-label=\"Drift "
      "minus {0}'s\">\n{2}{3}</svg>{4}{5}</div>\n<p class=\"axis below\">drift minus {0}'s, % of "
      "the path</p>\n",
      escape_html(table.methods[table.against].title), 2.2 * static_cast<double>(rows.size()),
      grid.svg, svg, grid.labels_html, marks);
}

std::string part_html(const SeedTable& part, const std::string& title) {
  return fmt::format("<h2>{}</h2>\n<p class=\"quiet\">{}</p>\n{}{}{}", escape_html(title),
                     escape_html(seeds_text(part)), titled_table_html(seeds_summary_table(part)),
                     titled_table_html(seeds_pair_table(part)), pairs_html(part));
}

}  // namespace

std::string seeds_html(const SeedTable& table) {
  const std::vector<std::string> names = drive_names(table);
  std::string body;
  if (names.size() > 1) body += part_html(table, "All drives");
  for (const std::string& name : names) body += part_html(of_drive(table, name), name);
  return table_page_html("16 rows, 16 lifted to 64, and 64 rows over many drives", kSeedsStyle,
                         body + notes_html(seeds_notes(table)));
}

}  // namespace hqslam::tools
