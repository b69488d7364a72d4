#include "table/table_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace hqslam::tools {

namespace {

void add(std::string& text, const char* level, const TextTable& table) {
  if (table.rows.empty()) return;
  text += fmt::format("{} {}\n\n{}\n", level, table.title, markdown_of(table));
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

ErrorPanel thinned(const ErrorPanel& panel) {
  ErrorPanel result{panel.title, panel.rmse_m, {}, {}, {}};
  const std::size_t step = (panel.path_m.size() + ErrorMap::kMostPoses - 1) / ErrorMap::kMostPoses;
  double error_m = 0.0;
  for (std::size_t i = 0; i < panel.path_m.size(); ++i) {
    error_m = std::max(error_m, panel.error_m[i]);
    if (i % step != 0 && i + 1 < panel.path_m.size()) continue;
    result.path_m.push_back(panel.path_m[i]);
    result.error_m.push_back(std::exchange(error_m, 0.0));
    result.distance_m.push_back(panel.distance_m[i]);
  }
  return result;
}

PageJson path_json(const std::vector<Eigen::Vector2d>& path_m) {
  std::vector<double> x, y;
  for (const Eigen::Vector2d& place_m : path_m) {
    x.push_back(place_m.x());
    y.push_back(place_m.y());
  }
  return {{"x", f32_block(x)}, {"y", f32_block(y)}};
}

/// The figure that tools/web/table.html draws as maps and as error over distance.
PageJson errors_json(const DriveFigures& drive, std::size_t loop_closing) {
  const ErrorMap map = error_map_of(drive, loop_closing);
  const ErrorScale scale = error_scale(map);
  PageJson json = {{"kind", "errors"},
                   {"loop_closing", kLoopClosingNames[loop_closing]},
                   {"top_m", scale.top_m},
                   {"clipped", scale.clipped},
                   {"reference", path_json(map.reference_m)},
                   {"panels", PageJson::array()}};
  for (const ErrorPanel& panel : map.panels) {
    PageJson& entry = json["panels"].emplace_back(path_json(panel.path_m));
    entry["title"] = panel.title;
    entry["rmse_m"] = panel.rmse_m;
    entry["error_m"] = f32_block(panel.error_m);
    entry["distance_m"] = f32_block(panel.distance_m);
  }
  return json;
}

ReportPart part_of(const DriveFigures& drive) {
  ReportPart part{drive.name, drive_text(drive), {}};
  if (!drive.truth.empty()) part.page_text = fmt::format("; truth: {}", drive.truth);
  for (std::size_t i = 0; i < kLoopClosingNames.size(); ++i) {
    part.tables.push_back(trajectory_table(drive, i));
    PageJson errors = errors_json(drive, i);
    if (!errors["panels"].empty()) part.figures.push_back(std::move(errors));
  }
  part.tables.push_back(upsampling_table(drive));
  return part;
}

}  // namespace

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
  PageJson data = {{"title", report.title},
                   {"lead", PageJson::array()},
                   {"parts", PageJson::array()},
                   {"notes", report.notes}};
  const auto add_table = [](const TextTable& table, PageJson& to) {
    if (!table.rows.empty()) to.push_back(json_of(table));
  };
  for (const TextTable& table : report.lead) add_table(table, data["lead"]);
  for (const ReportPart& part : report.parts) {
    PageJson& entry = data["parts"].emplace_back(PageJson{{"title", part.title},
                                                          {"text", part.text + part.page_text},
                                                          {"tables", PageJson::array()},
                                                          {"figures", part.figures}});
    for (const TextTable& table : part.tables) add_table(table, entry["tables"]);
  }
  return page_html("table", std::move(data));
}

ErrorScale error_scale(const ErrorMap& map) {
  constexpr double kMostOverMedian = 3.0;
  std::vector<double> largest_m;
  for (const ErrorPanel& panel : map.panels) {
    if (!panel.error_m.empty()) {
      largest_m.push_back(*std::ranges::max_element(panel.error_m));
    }
  }
  if (largest_m.empty()) return {};
  std::ranges::sort(largest_m);
  const double limit_m = kMostOverMedian * largest_m[(largest_m.size() - 1) / 2];
  return {std::min(largest_m.back(), limit_m), largest_m.back() > limit_m};
}

ErrorMap error_map_of(const DriveFigures& drive, std::size_t loop_closing) {
  ErrorMap map;
  const MethodFigures* all_rows = find_method(drive, table_methods().back().name);
  if (all_rows == nullptr) return map;
  const Trajectory& reference = all_rows->result.trajectory[loop_closing];
  for (const StampedPose& pose : reference) {
    map.reference_m.push_back(pose.T_map_sensor.translation().head<2>());
  }
  for (const MethodFigures& figures : drive.methods) {
    const auto& error = figures.against_all_rows[loop_closing];
    if (!error) continue;
    ErrorPanel panel{figures.method.title,
                     error->ape_rmse_m(),
                     {},
                     error->ape.translation_m,
                     distances_m(reference, error->ape.pairs)};
    for (const std::size_t index : error->ape.pairs.estimate) {
      panel.path_m.push_back(
          error->ape.aligned_estimate[index].T_map_sensor.translation().head<2>());
    }
    map.panels.push_back(thinned(panel));
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
  }
  report.notes = drives_notes(drives);
  report.json = drives_json(drives);
  return report;
}

}  // namespace hqslam::tools
