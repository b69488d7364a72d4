#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "pages/text_table.h"
#include "table/table_figures.h"
#include "table/table_statistics.h"

namespace hqslam::tools {

/// The trajectory of one method seen from above, in the frame of LiDAR-64's, and its error at each
/// of its poses, evenly thinned to at most kMostPathPoses.
struct ErrorPath {
  std::string method;  ///< title
  double rmse_m = 0.0;
  std::vector<double> x_m;
  std::vector<double> y_m;
  std::vector<double> distance_m;  ///< along LiDAR-64's trajectory
  std::vector<double> error_m;     ///< position, after the alignment
};
inline constexpr std::size_t kMostPathPoses = 1000;

/// The paper's figure 2: the trajectories of one drive's methods beside LiDAR-64's.
struct ErrorMap {
  std::string title;
  std::vector<double> reference_x_m;
  std::vector<double> reference_y_m;
  std::vector<ErrorPath> paths;
};
/// Nothing in it but the title where LiDAR-64 is not in the table.
ErrorMap error_map_of(const DriveFigures& drive, std::size_t loop_closing);

/// The drift of a method minus that of the method that it is paired with.
struct PairedDrift {
  std::string method;                       ///< title
  std::vector<double> differences_percent;  ///< one per drive; NaN where a drive has none
  Estimate mean_percent;
};

/// One drive, or all drives of a kind.
struct ReportPart {
  std::string title;
  std::string text;
  std::vector<TextTable> tables;
  std::vector<ErrorMap> error_maps = {};
  std::string paired_with = {};  ///< title of the method that the others are paired with
  std::vector<PairedDrift> paired_drifts = {};
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

// The tables of a report on drives.

/// The paper's table: RMSE against LiDAR-64 on all drives, frames per second, parameters.
TextTable paper_table(const std::vector<DriveFigures>& drives, std::size_t loop_closing);
/// Errors and times of the trajectories.
TextTable trajectory_table(const DriveFigures& drive, std::size_t loop_closing);
/// Image errors, speed and size of the upsampling.
TextTable upsampling_table(const DriveFigures& drive);
/// "town: 4000 scans, sensor os1-64, 2963 m of path"
std::string drive_text(const DriveFigures& drive);
std::vector<std::string> drives_notes(const std::vector<DriveFigures>& drives);
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
