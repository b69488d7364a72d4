#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string_view>

#include "files/scan_files.h"
#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "hqslam/core/whole_file.h"
#include "hqslam/core/words.h"

namespace hqslam::recordings {

namespace {

constexpr std::size_t kMaxStampsFileBytes = 256U << 20U;

std::optional<double> finite_number(std::string_view text) {
  const auto value = number_from<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

/// "2011-09-26 13:02:25.594360375" as seconds since 1970.
std::optional<double> date_s(std::string_view text) {
  constexpr std::string_view kForm = "0000-00-00 00:00:00";
  if (text.size() < kForm.size()) return std::nullopt;
  for (std::size_t i = 0; i < kForm.size(); ++i) {
    const bool digit = text[i] >= '0' && text[i] <= '9';
    if (kForm[i] == '0' ? !digit : text[i] != kForm[i]) return std::nullopt;
  }
  const auto part = [&](std::size_t at, std::size_t count) {
    int value = 0;
    std::from_chars(text.data() + at, text.data() + at + count, value);
    return value;
  };
  const std::chrono::year_month_day day(std::chrono::year(part(0, 4)),
                                        std::chrono::month(static_cast<unsigned>(part(5, 2))),
                                        std::chrono::day(static_cast<unsigned>(part(8, 2))));
  const std::string_view rest = text.substr(kForm.size());
  if (!rest.empty() && rest.front() != '.') return std::nullopt;
  const auto fraction = rest.empty() ? std::optional(0.0) : finite_number(fmt::format("0{}", rest));
  if (!day.ok() || !fraction) return std::nullopt;
  const auto days = std::chrono::sys_days(day).time_since_epoch().count();
  return 86400.0 * static_cast<double>(days) + 3600.0 * part(11, 2) + 60.0 * part(14, 2) +
         part(17, 2) + *fraction;
}

/// The last number in a file's name without its extension, of digits and points; empty without one.
std::string last_number(const std::string& path) {
  const std::string stem = std::filesystem::path(path).stem().string();
  const std::size_t end = stem.find_last_of("0123456789");
  if (end == std::string::npos) return {};
  const std::size_t before = stem.find_last_not_of("0123456789.", end);
  const std::size_t begin = before == std::string::npos ? 0 : before + 1;
  return stem.substr(begin, end + 1 - begin);
}

/// By the size of a number of this century: nanoseconds have 19 digits, seconds 10.
double seconds_of(double value) {
  if (value > 1e17) return 1e-9 * value;
  if (value > 1e14) return 1e-6 * value;
  if (value > 1e11) return 1e-3 * value;
  return value;
}

}  // namespace

std::vector<double> read_stamps_s(const std::string& path) {
  const std::string file = whole_file(path, "a file of stamps", kMaxStampsFileBytes);
  std::vector<double> stamps_s;
  std::size_t line_number = 0;
  for (std::string_view rest = file; !rest.empty();) {
    std::string_view line = next_line(rest);
    ++line_number;
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
    if (line.empty() || line.starts_with('#')) continue;
    const auto seconds = finite_number(line);
    const auto stamp_s = seconds ? seconds_of(*seconds) : date_s(line).value_or(NAN);
    if (std::isnan(stamp_s)) {
      throw Error(
          "{}: line {}: expected seconds, or a date as 2011-09-26 13:02:25.594360375, found '{}'; "
          "correct the line",
          path, line_number, excerpt(line));
    }
    stamps_s.push_back(stamp_s);
  }
  if (stamps_s.empty()) {
    throw Error(
        "{}: expected a stamp on each line, found none; give a file with a line for each scan",
        path);
  }
  return stamps_s;
}

std::vector<double> stamps_from_names_s(const std::vector<std::string>& paths) {
  std::vector<double> stamps_s;
  for (const std::string& path : paths) {
    const auto value = finite_number(last_number(path));
    if (!value) {
      throw Error(
          "{}: expected a stamp in the file's name, found no number; give the stamps in a "
          "file",
          path);
    }
    stamps_s.push_back(seconds_of(*value));
  }
  return stamps_s;
}

std::optional<double> stamp_spacing_s(const std::string& wanted) {
  const auto spacing_s = finite_number(wanted);
  return spacing_s && *spacing_s > 0.0 ? spacing_s : std::nullopt;
}

std::vector<std::size_t> numbers_with_gaps(const std::vector<std::string>& paths) {
  constexpr std::size_t kMostDigits = 9;
  constexpr std::size_t kMostThinned = 10;
  std::vector<std::size_t> numbers;
  std::size_t least_step = kMostThinned + 1;
  for (const std::string& path : paths) {
    const std::string text = last_number(path);
    const auto number = text.size() > kMostDigits ? std::nullopt : number_from<std::size_t>(text);
    if (!number || (!numbers.empty() && *number <= numbers.back())) return {};
    if (!numbers.empty()) least_step = std::min(least_step, *number - numbers.back());
    numbers.push_back(*number);
  }
  const bool has_gaps = !numbers.empty() && numbers.back() - numbers.front() >= numbers.size();
  return has_gaps && least_step <= kMostThinned ? numbers : std::vector<std::size_t>();
}

}  // namespace hqslam::recordings
