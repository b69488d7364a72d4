#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pages/text_table.h"
#include "table/table_figures.h"
#include "table/table_statistics.h"

namespace hqslam::tools {

/// One drive, or all drives of a kind.
struct ReportPart {
  std::string title;
  std::string text;
  std::vector<TextTable> tables;
  // What the page draws, as its script takes it.
  nlohmann::ordered_json error_maps = nlohmann::ordered_json::array();  ///< of error_map_of
  std::string paired_with = {};  ///< title of the method that the others are paired with
  /// The drift of each other method minus that one's, %: {name, dots: one per drive, NaN where a
  /// drive has none, mean, low, high}.
  nlohmann::ordered_json paired_drifts = nlohmann::ordered_json::array();
};

/// The content of table.md and table.html.
struct TableReport {
  std::string title;            ///< of the page
  std::vector<TextTable> lead;  ///< tables of all parts together
  std::vector<ReportPart> parts;
  std::vector<std::string> notes;  ///< what the columns mean and how it was measured
  std::string json;                ///< table.json
};

/// A part with tables and error maps for each drive.
TableReport drives_report(const std::vector<DriveFigures>& drives);
/// A part for all drives from seeds and one for each kind, with tables and paired drifts.
TableReport statistics_report(const TableSample& sample);

/// What is printed: the tables of all parts together or, where there are none, those of the first
/// part, which has all drives.
std::string printed(const TableReport& report);
std::string markdown_of(const TableReport& report);
/// tools/web/table.html
std::string html_of(const TableReport& report);
/// The data of that page, from which its script draws tables, maps and charts.
nlohmann::ordered_json page_data(const TableReport& report);

// The parts of a report on drives.

/// The paper's table: RMSE against LiDAR-64 on all drives, frames per second, parameters.
TextTable paper_table(const std::vector<DriveFigures>& drives, std::size_t loop_closing);
/// Errors and times of the trajectories.
TextTable trajectory_table(const DriveFigures& drive, std::size_t loop_closing);
/// Image errors, speed and size of the upsampling.
TextTable upsampling_table(const DriveFigures& drive);
/// The paper's figure 2, in the frame of LiDAR-64's trajectory: {title, reference: {x_m, y_m},
/// paths: of each other method {name, rmse_m, x_m, y_m, distance_m: along LiDAR-64's trajectory,
/// error_m: of the position, after the alignment}}, evenly thinned to at most kMostPathPoses.
/// Nothing in it but the title where LiDAR-64 is not in the table.
nlohmann::ordered_json error_map_of(const DriveFigures& drive, std::size_t loop_closing);
inline constexpr std::size_t kMostPathPoses = 1000;
/// A number with about three significant digits: "0.042", "3.78", "31.7", "6717".
std::string three_digits(double value);

// table.json.

/// In every table.json: tells one from other files.
inline constexpr const char* kTableJsonMarker = R"("written_by": "hqslam-lab table")";
/// {"drives": figures that are the same in every run, "timings": those that are not}.
std::string drives_json(const std::vector<DriveFigures>& drives);
/// Per method the figures of its rows, and those of every drive. All but "slam_ms" are the same in
/// every run.
std::string statistics_json(const std::vector<PartStatistics>& parts);

}  // namespace hqslam::tools
