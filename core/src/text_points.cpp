#include "text_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "hqslam/core/whole_file.h"
#include "words.h"

namespace hqslam {

namespace {

constexpr std::size_t kMaxFileBytes = std::size_t{1} << 29U;
constexpr std::size_t kMaxColumns = 100;
constexpr std::string_view kSeparators = " \t\r,;";

std::optional<double> number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto parsed = std::from_chars(word.data(), word.data() + word.size(), value);
  if (parsed.ptr != word.data() + word.size()) return std::nullopt;
  if (parsed.ec == std::errc::result_out_of_range) return HUGE_VAL;
  return parsed.ec == std::errc() ? std::optional(value) : std::nullopt;
}

/// Which column is which; -1: none.
struct Columns {
  int x = 0, y = 1, z = 2, ring = -1, time = -1;
  std::string ring_name = "ring";
  std::string time_name = "t";
  bool named = false;
};

Columns named_columns(const std::vector<std::string_view>& names, const std::string& path) {
  Columns columns;
  columns.named = true;
  columns.x = columns.y = columns.z = -1;
  const auto is_one_of = [](std::string_view name, const auto& of) {
    return std::find(std::begin(of), std::end(of), name) != std::end(of);
  };
  for (std::size_t i = 0; i < names.size(); ++i) {
    const int column = static_cast<int>(i);
    const std::string_view name = names[i];
    if (name == "x") columns.x = column;
    if (name == "y") columns.y = column;
    if (name == "z") columns.z = column;
    if (is_one_of(name, kRingNames)) {
      columns.ring = column;
      columns.ring_name = name;
    }
    if (is_one_of(name, kTimeNames)) {
      columns.time = column;
      columns.time_name = name;
    }
  }
  if (columns.x < 0 || columns.y < 0 || columns.z < 0) {
    throw Error(
        fmt::format("{}: expected columns x y z, found a first line without them; name the "
                    "columns or leave the names out",
                    path));
  }
  return columns;
}

Columns usual_columns(std::size_t count) {
  Columns columns;
  if (count > 4) columns.ring = 4;
  if (count > 5) columns.time = 5;
  return columns;
}

}  // namespace

RawPoints read_text_points(const std::string& path) {
  const std::string file = whole_file(path, "a .txt or .csv file of points", kMaxFileBytes);
  RawPoints points;
  std::optional<Columns> columns;
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
    if (!columns) {
      const bool names = !number(words.front());
      columns = names ? named_columns(words, path) : usual_columns(words.size());
      count = words.size();
      points.ring_name = columns->ring_name;
      points.time.name = columns->time_name;
      if (names) continue;
    }
    bool good = words.size() == count && count >= 3;
    for (std::size_t i = 0; good && i < count; ++i) {
      const auto value = number(words[i]);
      good = value.has_value();
      if (good) values[i] = *value;
    }
    if (!good) {
      throw Error(
          fmt::format("{}: line {}: expected {} numbers x y z [intensity ring t], found "
                      "'{}'; correct the line",
                      path, line_number, std::max<std::size_t>(count, 3), excerpt(line)));
    }
    const auto at = [&](int column) { return values[static_cast<std::size_t>(column)]; };
    if (!points.add(at(columns->x), at(columns->y), at(columns->z))) continue;
    if (columns->ring >= 0) points.ring.push_back(at(columns->ring));
    if (columns->time >= 0) {
      points.time.values.push_back(at(columns->time));
      whole_times = whole_times && std::floor(at(columns->time)) == at(columns->time);
    }
  }
  if (!columns) throw Error(fmt::format("{}: expected points, found none; record again", path));
  points.time.whole_numbers = whole_times;
  return points;
}

}  // namespace hqslam
