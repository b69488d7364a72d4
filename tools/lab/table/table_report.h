#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "pages/page.h"
#include "pages/text_table.h"
#include "table/table_figures.h"
#include "table/table_statistics.h"

namespace hqslam::tools {

/// A trajectory from above in the reference's frame, with its error at every pose.
struct ErrorPanel {
  std::string title;
  double rmse_m = 0.0;
  std::vector<Eigen::Vector2d> path_m;
  std::vector<double> error_m;     ///< one per pose
  std::vector<double> distance_m;  ///< along the reference up to each pose
};

/// The paper's figure 2: trajectories of one drive, coloured by their error, side by side. Long
/// trajectories are thinned to kMostPoses; the error of a pose is then the largest of those left
/// out before it.
struct ErrorMap {
  static constexpr std::size_t kMostPoses = 2000;

  std::vector<Eigen::Vector2d> reference_m;
  std::vector<ErrorPanel> panels;
};

/// Which error has the last colour, in every panel.
struct ErrorScale {
  double top_m = 1.0;
  bool clipped = false;  ///< some errors are larger
};
/// The largest error of all panels, but at most three times the median of the panels' largest
/// ones: one trajectory that leaves the map does not take the colours from all others.
ErrorScale error_scale(const ErrorMap& map);

/// A number with three digits that count: "0.042", "3.78", "31.7", "6717".
std::string three_digits(double value);

/// The paper's table: RMSE against LiDAR-64 on all drives, frames per second, parameters.
TextTable paper_table(const std::vector<DriveFigures>& drives, std::size_t loop_closing);
/// Errors and times of the trajectories.
TextTable trajectory_table(const DriveFigures& drive, std::size_t loop_closing);
/// Image errors, speed and size of the upsampling.
TextTable upsampling_table(const DriveFigures& drive);

/// "town: 4000 scans of an os1-64, 2963 m; ..."
std::string drive_text(const DriveFigures& drive);
/// What the columns mean and how it was measured.
std::vector<std::string> drives_notes(const std::vector<DriveFigures>& drives);

/// One drive, or all of a kind.
struct ReportPart {
  std::string title;
  std::string text;
  std::vector<TextTable> tables;
  std::string page_text = {};            ///< behind `text`, on the page alone
  PageJson figures = PageJson::array();  ///< on the page alone, below the tables
};

/// All that a table says: table.md and table.html are written from it.
struct TableReport {
  std::string title;            ///< of the page
  std::vector<TextTable> lead;  ///< tables of all parts together
  std::vector<ReportPart> parts;
  std::vector<std::string> notes;  ///< what the columns mean and how it was measured
  std::string json;                ///< table.json
};

/// The report of drives: tables, error maps and error over distance.
TableReport drives_report(const std::vector<DriveFigures>& drives);
/// The report of many drives from seeds, together and by kind: tables, and each method's drift
/// minus the one's that it is paired with: a dot per drive, the mean and its interval.
TableReport statistics_report(const TableSample& sample);

/// What is printed: the tables of all parts together, or those of the first part, which is all.
std::string printed(const TableReport& report);
std::string markdown_of(const TableReport& report);
/// tools/web/table.html
std::string html_of(const TableReport& report);

/// In every table.json: tells one from other files.
inline constexpr const char* kTableJsonMarker = R"("written_by": "hqslam-lab table")";
/// {"drives": figures that are the same in every run, "timings": those that are not}.
std::string drives_json(const std::vector<DriveFigures>& drives);

/// The statistics of a part of a sample, for all drives "all".
struct PartStatistics {
  std::string name;
  TableSample sample;
  std::vector<MethodStatistics> methods;
};
/// All drives, then those of each kind.
std::vector<PartStatistics> parts_of(const TableSample& sample);
/// Per method what its rows say, and what it did on every drive. Figures that are the same in every
/// run, but for "slam_ms".
std::string statistics_json(const std::vector<PartStatistics>& parts);

/// Statistics of every method: what is written of each, in tables and in files.
struct StatisticsColumn {
  const char* column;
  const char* key;  ///< in files; nullptr: not as an estimate
  int decimals;     ///< in tables
  bool of_others;   ///< says nothing of the method that the others are paired with
  std::function<std::optional<Estimate>(const MethodStatistics& method)> of;
};
const std::vector<StatisticsColumn>& summary_columns();
const std::vector<StatisticsColumn>& pair_columns();

/// The trajectories of a drive's methods against LiDAR-64's; empty if that is not there.
ErrorMap error_map_of(const DriveFigures& drive, std::size_t loop_closing);

}  // namespace hqslam::tools
