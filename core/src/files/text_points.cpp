#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "files/point_files.h"
#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "hqslam/core/whole_file.h"
#include "hqslam/core/words.h"

namespace hqslam {

namespace {

constexpr std::size_t kMaxTextFileBytes = std::size_t{1} << 29U;
constexpr std::size_t kMaxColumns = 100;
constexpr std::string_view kSeparators = " \t\r,;";

std::optional<double> signed_decimal(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  return number_from<double>(word);
}

/// The names in a line; where commas separate them they may have blanks: "X (m), Y (m)".
std::vector<std::string_view> column_names(std::string_view line) {
  const bool has_commas = line.find_first_of(",;") != std::string_view::npos;
  return words_of(line, has_commas ? ",;\r" : kSeparators, kMaxColumns);
}

std::vector<PointField> columns_named(const std::vector<std::string_view>& names) {
  std::vector<PointField> columns;
  for (std::size_t i = 0; i < names.size(); ++i) columns.push_back({std::string(names[i]), {}, i});
  return columns;
}

/// Where no line names them. Fewer than three are complained about line by line.
std::vector<PointField> usual_columns(std::size_t count) {
  std::vector<std::string_view> names = {"x", "y", "z", "intensity", "ring", "t"};
  names.resize(std::clamp<std::size_t>(count, 3, names.size()));
  return columns_named(names);
}

}  // namespace

RawPoints read_text_points(const std::string& path) {
  const std::string file = whole_file(path, "a .txt or .csv file of points", kMaxTextFileBytes);
  std::vector<PointField> columns;
  PointFields fields;
  std::optional<RawPoints> points;
  std::size_t count = 0;
  std::size_t line_number = 0;
  bool whole_times = true;
  std::array<double, kMaxColumns> values{};
  for (std::string_view rest = file; !rest.empty();) {
    const std::string_view line = next_line(rest);
    ++line_number;
    if (line.starts_with('#') || line.starts_with("//")) continue;
    const std::vector<std::string_view> words = words_of(line, kSeparators, kMaxColumns);
    if (words.empty()) continue;
    if (!points) {
      const bool names = !signed_decimal(words.front());
      columns = names ? columns_named(column_names(line)) : usual_columns(words.size());
      count = names ? columns.size() : words.size();
      fields = point_fields(columns, path, "columns");
      points.emplace(fields, 0);
      if (names) continue;
    }
    bool good = words.size() == count && count >= 3;
    for (std::size_t i = 0; good && i < count; ++i) {
      const auto value = signed_decimal(words[i]);
      good = value.has_value();
      if (good) values[i] = *value;
    }
    if (!good) {
      throw Error(
          "{}: line {}: expected {} numbers x y z [intensity ring t], found '{}'; correct the line",
          path, line_number, std::max<std::size_t>(count, 3), excerpt(line));
    }
    points->add(fields, [&](const PointField& field) { return values[field.offset]; });
    if (fields.time != nullptr) {
      const double time = values[fields.time->offset];
      whole_times = whole_times && std::floor(time) == time;
    }
  }
  if (!points) throw Error("{}: expected points, found none; record again", path);
  points->time.whole_numbers = whole_times;
  return std::move(*points);
}

}  // namespace hqslam
