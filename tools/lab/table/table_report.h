#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pages/text_table.h"
#include "table/table_parts.h"

namespace hqslam::tools {

/// The figures of a part: a row for each method.
struct PartReport {
  TablePart part;
  std::string text;                ///< drives, seeds, scans and length
  std::vector<TextTable> tables;   ///< summary, and drive by drive
  nlohmann::ordered_json methods;  ///< per method {key: {value, low, high}}
};
PartReport report_of(const TablePart& part);

/// The tables for a terminal: those of all drives together or, without them, of every part.
std::string printed(const std::vector<PartReport>& parts);
/// table.md
std::string markdown_of(const std::vector<PartReport>& parts);
/// The data of tools/web/table.html, from which its script draws tables, maps and charts.
nlohmann::ordered_json page_data(const std::vector<PartReport>& parts);
/// table.json: the figures of every method and part, and those of every drive. The same in every
/// run.
std::string json_of(const std::vector<PartReport>& parts);
/// The marker by which a table.json is recognized.
inline constexpr const char* kTableJsonMarker = R"("written_by": "hqslam-lab table")";

}  // namespace hqslam::tools
