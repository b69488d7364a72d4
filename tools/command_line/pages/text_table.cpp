#include "pages/text_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

namespace hqslam::tools {

std::string markdown_of(const TextTable& table) {
  const auto line_of = [](const std::vector<std::string>& cells) {
    return fmt::format("| {} |\n", fmt::join(cells, " | "));
  };
  std::vector<std::string> rule(table.columns.size(), "---:");
  rule.front() = "---";
  std::string text = line_of(table.columns) + line_of(rule);
  for (const std::vector<std::string>& row : table.rows) text += line_of(row);
  return text;
}

std::string figure_text(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : kNoFigure;
}

nlohmann::ordered_json json_of(const TextTable& table) {
  return {{"title", table.title},
          {"columns", table.columns},
          {"rows", table.rows},
          {"links", table.links}};
}

}  // namespace hqslam::tools
