#include <fmt/format.h>
#include <fmt/ranges.h>

#include "laboratory/table/table_output.h"

namespace hqslam::tools {
namespace {

std::string line_of(const std::vector<std::string>& cells) {
  return fmt::format("| {} |\n", fmt::join(cells, " | "));
}

}  // namespace

std::string markdown_of(const TextTable& table) {
  std::vector<std::string> rule(table.columns.size(), "---:");
  rule.front() = "---";
  std::string text = line_of(table.columns) + line_of(rule);
  for (const std::vector<std::string>& row : table.rows) text += line_of(row);
  return text;
}

std::string table_markdown(const std::vector<DriveFigures>& drives) {
  std::string text;
  const auto add = [&](const TextTable& table, const char* level) {
    if (table.rows.empty()) return;
    text += fmt::format("{} {}\n\n{}\n", level, table.title, markdown_of(table));
  };
  for (std::size_t i = 0; i < kLoopClosingNames.size(); ++i) add(paper_table(drives, i), "##");
  for (const DriveFigures& drive : drives) {
    text += fmt::format("## {}\n\n{}\n\n", drive.name, drive_text(drive));
    for (std::size_t i = 0; i < kLoopClosingNames.size(); ++i) {
      add(trajectory_table(drive, i), "###");
    }
    add(upsampling_table(drive), "###");
  }
  text += "## Notes\n\n";
  for (const std::string& note : table_notes(drives)) text += fmt::format("- {}\n", note);
  return text;
}

}  // namespace hqslam::tools
