#include "table/table_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "report/chart.h"

namespace hqslam::tools {

namespace {

/// What the tables' pages add to the reports' style: they are wider.
constexpr std::string_view kPageStyle = R"css(
body { max-width: 84rem; }
h2 { font-size: 1.3rem; margin-top: 3.5rem; }
td { white-space: nowrap; }
.tables { display: grid; gap: 0 3rem; grid-template-columns: repeat(auto-fit, minmax(min(36rem, 100%), 1fr)); }
)css";

void add(std::string& text, const char* level, const TextTable& table) {
  if (table.rows.empty()) return;
  text += fmt::format("{} {}\n\n{}\n", level, table.title, markdown_of(table));
}

/// Of its figures.
constexpr std::string_view kTableStyle = R"css(
.maps { display: grid; gap: 1rem; grid-template-columns: repeat(auto-fill, minmax(min(17rem, 100%), 1fr)); }
.maps figure { margin: 0; }
.maps svg { width: 100%; height: auto; display: block; border-radius: 6px; }
.maps figcaption { display: flex; justify-content: space-between; gap: .5rem; font-size: .85rem; margin-bottom: .25rem; }
.maps figcaption span { color: var(--quiet); }
.legend .reference-line { width: 1.6rem; height: 0; border-radius: 0; background: none; border-top: 2px solid #c4c9d0; }
)css";

/// One per method, told apart on white and on black.
constexpr std::array<const char*, 10> kMethodColors = {"#8a919c", "#e2a33c", "#3f9e8c", "#4a78c8",
                                                       "#7ea2ff", "#b4588f", "#d8433a", "#5a9e3f",
                                                       "#9c6ade", "#a0785a"};

constexpr std::size_t kMostChartPoints = 400;

std::string color_style() {
  std::string css;
  for (std::size_t i = 0; i < kMethodColors.size(); ++i) {
    css += fmt::format(".plot .line.m{0} {{ stroke: {1}; }}\ni.m{0} {{ color: {1}; }}\n", i,
                       kMethodColors[i]);
  }
  return css;
}

std::string scale_html(const ErrorScale& scale) {
  return fmt::format(
      "<ul class=\"legend\"><li>distance 0<i class=\"scale\" "
      "style=\"background:linear-gradient(90deg, {})\"></i>{}</li>"
      "<li><i class=\"reference-line\"></i>LiDAR-64, ring: the start</li></ul>\n",
      error_gradient(), top_text(scale));
}

std::string maps_html(const DriveFigures& drive, std::size_t loop_closing) {
  const ErrorMap map = error_map_of(drive, loop_closing);
  if (map.panels.empty()) return "";
  const ErrorScale scale = error_scale(map);
  std::string html = fmt::format(
      "<h3>Where the error is, loop closing {}</h3>\n<p class=\"quiet\">Trajectories from above, "
      "coloured by their distance from LiDAR-64's after the alignment; one scale for all.</p>\n{}"
      "<div class=\"maps\">\n",
      kLoopClosingNames[loop_closing], scale_html(scale));
  for (std::size_t i = 0; i < map.panels.size(); ++i) {
    html += fmt::format("<figure><figcaption>{}<span>{}</span></figcaption>{}</figure>\n",
                        escape_html(map.panels[i].title), error_text(map.panels[i]),
                        panel_svg(map, i, scale));
  }
  return html + "</div>\n";
}

/// Metres along the reference up to each pair of an error's poses.
std::vector<double> distances_m(const Trajectory& reference, const PosePairs& pairs) {
  std::vector<double> distances = {0.0};
  for (std::size_t i = 1; i < pairs.reference.size(); ++i) {
    const auto position = [&](std::size_t pair) {
      return reference[pairs.reference[pair]].T_map_sensor.translation();
    };
    distances.push_back(distances.back() + (position(i) - position(i - 1)).norm());
  }
  return distances;
}

/// One class per method, the same on every drive.
std::string class_of(const TableMethod& method, std::size_t position) {
  const std::vector<std::string> known = table_method_names();
  const auto found = std::ranges::find(known, method.name);
  const std::size_t index =
      found != known.end() ? static_cast<std::size_t>(found - known.begin()) : position;
  return fmt::format("m{}", index % kMethodColors.size());
}

/// Every n-th value, so that at most kMostChartPoints are left.
std::vector<double> thinned(const std::vector<double>& values) {
  const std::size_t step = (values.size() + kMostChartPoints - 1) / kMostChartPoints;
  std::vector<double> kept;
  for (std::size_t i = 0; i < values.size(); i += step) kept.push_back(values[i]);
  return kept;
}

std::string chart_of(const DriveFigures& drive, std::size_t loop_closing) {
  const MethodFigures* all_rows = find_method(drive, table_methods().back().name);
  const ErrorScale scale = error_scale(error_map_of(drive, loop_closing));
  Chart chart;
  chart.x_label = "distance along LiDAR-64's path, m";
  chart.y_label = scale.clipped
                      ? fmt::format("position error, m (cut off at {:.3g} m)", scale.top_m)
                      : "position error, m";
  for (std::size_t i = 0; i < drive.methods.size(); ++i) {
    const auto& error = drive.methods[i].against_all_rows[loop_closing];
    if (!error) continue;
    std::vector<double> values_m = thinned(error->ape.translation_m);
    for (double& value_m : values_m) value_m = std::min(value_m, scale.top_m);
    chart.x = thinned(distances_m(all_rows->result.trajectory[loop_closing], error->ape.pairs));
    chart.series.push_back(
        {drive.methods[i].method.title, class_of(drive.methods[i].method, i), std::move(values_m)});
  }
  if (chart.series.empty()) return "";
  return fmt::format("<h3>Error over distance, loop closing {}</h3>\n{}",
                     kLoopClosingNames[loop_closing], chart_html(chart));
}

ReportPart part_of(const DriveFigures& drive) {
  ReportPart part{drive.name, drive_text(drive), {}};
  if (!drive.truth.empty()) part.page_text = fmt::format("; truth: {}", drive.truth);
  for (std::size_t i = 0; i < kLoopClosingNames.size(); ++i) {
    part.tables.push_back(trajectory_table(drive, i));
    part.figures_html += maps_html(drive, i);
  }
  for (std::size_t i = 0; i < kLoopClosingNames.size(); ++i)
    part.figures_html += chart_of(drive, i);
  part.tables.push_back(upsampling_table(drive));
  return part;
}

void add_pictures(const DriveFigures& drive, TableReport& report) {
  for (std::size_t i = 0; i < kLoopClosingNames.size(); ++i) {
    const ErrorMap map = error_map_of(drive, i);
    if (map.panels.empty()) continue;
    const std::string title =
        fmt::format("{}: {} scans, loop closing {}", drive.name, drive.scans, kLoopClosingNames[i]);
    report.pictures.emplace_back(picture_name(drive.name, i), error_map_svg(map, title));
  }
}

}  // namespace

std::string picture_name(const std::string& drive, std::size_t loop_closing) {
  return fmt::format("{}-loop-closing-{}.svg", drive, kLoopClosingNames[loop_closing]);
}

std::string printed(const TableReport& report) {
  std::string text;
  for (const TextTable& table : report.lead.empty() ? report.parts.front().tables : report.lead) {
    text += fmt::format("{}\n\n{}\n", table.title, markdown_of(table));
  }
  return text;
}

std::string markdown_of(const TableReport& report) {
  std::string text;
  for (const TextTable& table : report.lead) add(text, "##", table);
  for (const ReportPart& part : report.parts) {
    text += fmt::format("## {}\n\n{}\n\n", part.title, part.text);
    for (const TextTable& table : part.tables) add(text, "###", table);
  }
  text += "## Notes\n\n";
  for (const std::string& note : report.notes) text += fmt::format("- {}\n", note);
  return text;
}

std::string html_of(const TableReport& report) {
  Page page("hqslam-lab table");
  page.style(kPageStyle);
  page.style(report.style);
  page.heading(1, report.title);
  page.html("<div class=\"tables\">\n");
  for (const TextTable& table : report.lead) {
    page.html("<div>");
    page.table(table);
    page.html("</div>\n");
  }
  page.html("</div>\n");
  for (const ReportPart& part : report.parts) {
    page.heading(2, part.title);
    page.paragraph(part.text + part.page_text);
    for (const TextTable& table : part.tables) page.table(table);
    page.html(part.figures_html);
  }
  page.heading(2, "Notes");
  page.list(report.notes);
  return page.text();
}

ErrorMap error_map_of(const DriveFigures& drive, std::size_t loop_closing) {
  ErrorMap map;
  const MethodFigures* all_rows = find_method(drive, table_methods().back().name);
  if (all_rows == nullptr) return map;
  for (const StampedPose& pose : all_rows->result.trajectory[loop_closing]) {
    map.reference_m.push_back(pose.T_map_sensor.translation().head<2>());
  }
  for (const MethodFigures& figures : drive.methods) {
    const auto& error = figures.against_all_rows[loop_closing];
    if (!error) continue;
    ErrorPanel panel{figures.method.title, error->ape_rmse_m(), {}, error->ape.translation_m};
    for (const std::size_t index : error->ape.pairs.estimate) {
      panel.path_m.push_back(
          error->ape.aligned_estimate[index].T_map_sensor.translation().head<2>());
    }
    map.panels.push_back(std::move(panel));
  }
  return map;
}

TableReport drives_report(const std::vector<DriveFigures>& drives) {
  TableReport report;
  report.title = "16 rows, 16 upsampled to 64, and 64 rows in one SLAM";
  for (std::size_t i = 0; i < kLoopClosingNames.size(); ++i) {
    report.lead.push_back(paper_table(drives, i));
  }
  for (const DriveFigures& drive : drives) {
    report.parts.push_back(part_of(drive));
    add_pictures(drive, report);
  }
  report.notes = drives_notes(drives);
  report.style = std::string(kTableStyle) + color_style();
  report.json = drives_json(drives);
  return report;
}

}  // namespace hqslam::tools
