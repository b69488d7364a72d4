#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "laboratory/table/error_map.h"
#include "laboratory/table/seeds_figures.h"
#include "laboratory/table/table_figures.h"
#include "laboratory/table/table_text.h"

namespace hqslam::tools {

/// table.md and table.html: one and the same of some drives, and of many from seeds. Each page
/// needs no other file: of drives tables, error maps and error over distance; over seeds tables,
/// and each method's drift minus the one's that it is paired with: a dot per drive, the mean and
/// its interval.
std::string table_markdown(const std::vector<DriveFigures>& drives);
std::string table_html(const std::vector<DriveFigures>& drives);
std::string seeds_markdown(const SeedTable& table);
std::string seeds_html(const SeedTable& table);

/// In every table.json: tells one from other files.
inline constexpr const char* kTableJsonMarker = "hqslam table";
/// table.json: {"drives": figures that are the same in every run, "timings": those that are not}.
std::string table_json(const std::vector<DriveFigures>& drives);
/// The same over seeds: per method what its rows say, and what it did on every drive. Figures that
/// are the same in every run, but for "slam_ms".
std::string seeds_json(const SeedTable& table);

/// The trajectories of a drive's methods against LiDAR-64's; nothing in it if that is not there.
ErrorMap error_map_of(const DriveFigures& drive, std::size_t loop_closing);

/// Drift, slips and APE of every method.
TextTable seeds_summary_table(const SeedTable& table);
/// Every method beside the one that the table pairs with.
TextTable seeds_pair_table(const SeedTable& table);
/// "town: seeds 1, 2, 3; 1000 scans each, 2.7 km"
std::string seeds_text(const SeedTable& table);
/// What the columns mean and how it was measured.
std::vector<std::string> seeds_notes(const SeedTable& table);

std::string markdown_of(const TextTable& table);
/// A table under its title; nothing if it has no rows.
std::string titled_table_html(const TextTable& table);
std::string notes_html(const std::vector<std::string>& notes);
/// The whole page. style: what it adds to the reports' and the tables' own.
std::string table_page_html(std::string_view title, std::string_view style,
                            const std::string& body);

}  // namespace hqslam::tools
