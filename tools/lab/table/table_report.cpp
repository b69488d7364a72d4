#include "table/table_report.h"

#include <fmt/format.h>

#include "pages/page.h"
#include "printing/printed_table.h"

namespace hqslam::tools {
namespace {

void add(std::string& text, const char* level, const TextTable& table) {
  if (table.rows.empty()) return;
  text += fmt::format("{} {}\n\n{}\n", level, table.title, markdown_of(table));
}

/// The path of a method with its errors; `reference`: LiDAR-64's trajectory.
ErrorPath path_of(const std::string& title, const AbsolutePoseError& ape,
                  const Trajectory& reference) {
  ErrorPath path;
  path.method = title;
  path.rmse_m = ape.translation_statistics.rmse;
  const std::size_t poses = ape.pairs.reference.size();
  const std::size_t step = (poses + kMostPathPoses - 1) / kMostPathPoses;
  const auto position_m = [&](std::size_t pair) -> Eigen::Vector3d {
    return reference[ape.pairs.reference[pair]].T_map_sensor.translation();
  };
  double distance_m = 0.0;
  for (std::size_t i = 0; i < poses; ++i) {
    if (i > 0) distance_m += (position_m(i) - position_m(i - 1)).norm();
    if (i % step != 0) continue;
    const StampedPose& pose = ape.aligned_estimate[ape.pairs.estimate[i]];
    path.x_m.push_back(pose.T_map_sensor.translation().x());
    path.y_m.push_back(pose.T_map_sensor.translation().y());
    path.distance_m.push_back(distance_m);
    path.error_m.push_back(ape.translation_m[i]);
  }
  return path;
}

ReportPart part_of(const DriveFigures& drive) {
  ReportPart part{drive.name, drive_text(drive), {}};
  for (std::size_t i = 0; i < kLoopClosingNames.size(); ++i) {
    part.tables.push_back(trajectory_table(drive, i));
    part.error_maps.push_back(error_map_of(drive, i));
  }
  part.tables.push_back(upsampling_table(drive));
  return part;
}

}  // namespace

std::string printed(const TableReport& report) {
  std::string text;
  for (const TextTable& table : report.lead.empty() ? report.parts.front().tables : report.lead) {
    text += fmt::format("{}\n\n{}\n", table.title, printed_table(table));
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

std::string html_of(const TableReport& report) { return page_html("table", page_data(report)); }

ErrorMap error_map_of(const DriveFigures& drive, std::size_t loop_closing) {
  ErrorMap map;
  map.title = fmt::format("loop closing {}", kLoopClosingNames[loop_closing]);
  const MethodFigures* all_rows = find_method(drive, table_methods().back().name);
  if (all_rows == nullptr) return map;
  const Trajectory& reference = all_rows->result.trajectory[loop_closing];
  const std::size_t step = (reference.size() + kMostPathPoses - 1) / kMostPathPoses;
  for (std::size_t i = 0; i < reference.size(); i += step) {
    map.reference_x_m.push_back(reference[i].T_map_sensor.translation().x());
    map.reference_y_m.push_back(reference[i].T_map_sensor.translation().y());
  }
  for (const MethodFigures& figures : drive.methods) {
    const auto& error = figures.against_all_rows[loop_closing];
    if (error) map.paths.push_back(path_of(figures.method.title, error->ape, reference));
  }
  return map;
}

TableReport drives_report(const std::vector<DriveFigures>& drives) {
  TableReport report;
  report.title = "16 rows, 16 upsampled to 64, and 64 rows in one SLAM";
  for (std::size_t i = 0; i < kLoopClosingNames.size(); ++i) {
    report.lead.push_back(paper_table(drives, i));
  }
  for (const DriveFigures& drive : drives) report.parts.push_back(part_of(drive));
  report.notes = drives_notes(drives);
  report.json = drives_json(drives);
  return report;
}

}  // namespace hqslam::tools
