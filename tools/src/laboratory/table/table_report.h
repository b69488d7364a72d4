#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "laboratory/table/error_map.h"
#include "laboratory/table/table_figures.h"
#include "laboratory/table/table_statistics.h"
#include "report/text_table.h"

namespace hqslam::tools {

/// One drive, or all of a kind.
struct ReportPart {
  std::string title;
  std::string text;
  std::vector<TextTable> tables;
  std::string page_text = {};     ///< behind `text`, on the page alone
  std::string figures_html = {};  ///< the same, below the tables
};

/// All that a table says: table.md and table.html are written from it.
struct TableReport {
  std::string title;            ///< of the page
  std::vector<TextTable> lead;  ///< tables of all parts together
  std::vector<ReportPart> parts;
  std::vector<std::string> notes;  ///< what the columns mean and how it was measured
  std::string style = {};          ///< of the page's figures
  std::string json;                ///< table.json
  /// Pictures: names of files and what is in them.
  std::vector<std::pair<std::string, std::string>> pictures = {};
};

/// "town-loop-closing-off.svg"
std::string picture_name(const std::string& drive, std::size_t loop_closing);

/// Of drives: tables, error maps and error over distance.
TableReport drives_report(const std::vector<DriveFigures>& drives);
/// Of many drives from seeds, together and by kind: tables, and each method's drift minus the one's
/// that it is paired with: a dot per drive, the mean and its interval.
TableReport statistics_report(const TableSample& sample);

/// What is printed: the tables of all parts together, or those of the first part, which is all.
std::string printed(const TableReport& report);
std::string markdown_of(const TableReport& report);
/// A page that needs no other file.
std::string html_of(const TableReport& report);

/// In every table.json: tells one from other files.
inline constexpr const char* kTableJsonMarker = "hqslam table";
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
  std::optional<Estimate> (*of)(const MethodStatistics& method);
};
const std::vector<StatisticsColumn>& summary_columns();
const std::vector<StatisticsColumn>& pair_columns();

/// The trajectories of a drive's methods against LiDAR-64's; nothing in it if that is not there.
ErrorMap error_map_of(const DriveFigures& drive, std::size_t loop_closing);

}  // namespace hqslam::tools
