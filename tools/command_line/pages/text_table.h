#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace hqslam::tools {

/// A table as text: the same cells are printed, written as Markdown and shown on pages.
struct TextTable {
  std::string title = {};            ///< empty: none
  std::vector<std::string> columns;  ///< the first names the rows
  std::vector<std::vector<std::string>> rows = {};
  std::vector<std::string> links = {};  ///< per row the page that its name leads to; empty: none
};

/// For a terminal, without its title: every column is as wide as its widest cell or the longest
/// word of its name, and long names are wrapped.
std::string printed_table(const TextTable& table);
/// As Markdown, without its title.
std::string markdown_of(const TextTable& table);
/// As pages take it: {title, columns, rows, links}.
nlohmann::ordered_json json_of(const TextTable& table);

/// What a column of a table means.
struct ColumnDefinition {
  const char* column;
  const char* text;  ///< one line, with the unit
};
/// A line for each, the texts below each other.
std::string printed_definitions(const std::vector<ColumnDefinition>& definitions);

/// Stands for a figure that is not there.
inline constexpr const char* kNoFigure = "-";

/// One figure of everything that a table or a file lists.
template <typename Row>
struct Figure {
  const char* column;  ///< its title in tables; nullptr: not in them
  const char* key;     ///< its name in files; nullptr: not in them
  int decimals = 3;    ///< in tables
  double scale = 1.0;  ///< from the value in files to that in tables
  std::function<std::optional<double>(const Row&)> of;
};

/// "0.250"; kNoFigure for nothing.
std::string figure_text(const std::optional<double>& value, int decimals);

/// A table of these figures: a row for each of `rows`, which `name` calls so.
template <typename Row, typename Name>
TextTable table_of(const std::vector<Row>& rows, const char* names,
                   const std::vector<Figure<Row>>& figures, const Name& name) {
  TextTable table{.columns = {names}};
  for (const auto& figure : figures) {
    if (figure.column != nullptr) table.columns.emplace_back(figure.column);
  }
  for (const Row& row : rows) {
    std::vector<std::string>& cells = table.rows.emplace_back();
    cells.push_back(name(row));
    for (const auto& figure : figures) {
      if (figure.column == nullptr) continue;
      std::optional<double> value = figure.of(row);
      if (value) *value *= figure.scale;
      cells.push_back(figure_text(value, figure.decimals));
    }
  }
  return table;
}

/// Adds the figures that a row has to a JSON object, under their keys.
template <typename Row, typename Json>
void add_figures(const Row& row, const std::vector<Figure<Row>>& figures, Json& json) {
  for (const auto& figure : figures) {
    if (figure.key == nullptr) continue;
    if (const std::optional<double> value = figure.of(row)) json[figure.key] = *value;
  }
}

}  // namespace hqslam::tools
