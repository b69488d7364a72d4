#include "pages/text_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

namespace hqslam::tools {
namespace {

/// The words of a column's name in lines no wider than `width`, or than the longest word.
std::vector<std::string> lines_of(const std::string& name, std::size_t width) {
  std::vector<std::string> lines;
  std::istringstream words(name);
  for (std::string word; words >> word;) {
    if (!lines.empty() && lines.back().size() + 1 + word.size() <= width) {
      lines.back() += " " + word;
    } else {
      lines.push_back(word);
    }
  }
  return lines;
}

std::size_t widest_of(const std::vector<std::string>& texts) {
  std::size_t width = 0;
  for (const std::string& text : texts) width = std::max(width, text.size());
  return width;
}

/// Names as short as this stay in one line.
constexpr std::size_t kShortName = 9;

std::vector<std::size_t> widths_of(const TextTable& table) {
  std::vector<std::size_t> widths;
  for (std::size_t column = 0; column < table.columns.size(); ++column) {
    std::size_t width = widest_of(lines_of(table.columns[column], kShortName));
    for (const auto& row : table.rows) width = std::max(width, row[column].size());
    widths.push_back(width);
  }
  return widths;
}

/// The first cell stands at the left, all others at the right of their columns.
std::string line_of(const std::vector<std::string>& cells, const std::vector<std::size_t>& widths) {
  std::string line = fmt::format("{:<{}}", cells.front(), widths.front());
  for (std::size_t i = 1; i < cells.size(); ++i) {
    line += fmt::format("  {:>{}}", cells[i], widths[i]);
  }
  return line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
}

}  // namespace

std::string printed_table(const TextTable& table) {
  const std::vector<std::size_t> widths = widths_of(table);
  std::vector<std::vector<std::string>> names;
  std::size_t height = 0;
  for (std::size_t i = 0; i < widths.size(); ++i) {
    names.push_back(lines_of(table.columns[i], widths[i]));
    height = std::max(height, names.back().size());
  }
  std::string text;
  for (std::size_t line = 0; line < height; ++line) {  // the last lines of all names are level
    std::vector<std::string> cells;
    for (const std::vector<std::string>& name : names) {
      const std::size_t empty = height - name.size();
      cells.push_back(line < empty ? "" : name[line - empty]);
    }
    text += line_of(cells, widths);
  }
  for (const std::vector<std::string>& row : table.rows) text += line_of(row, widths);
  return text;
}

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

std::string printed_definitions(const std::vector<ColumnDefinition>& definitions) {
  std::size_t width = 0;
  for (const auto& [column, _] : definitions) {
    width = std::max(width, std::string(column).size());
  }
  std::string text;
  for (const auto& [column, definition] : definitions) {
    text += fmt::format("  {:<{}}  {}\n", column, width, definition);
  }
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
