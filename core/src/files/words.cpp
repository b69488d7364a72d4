#include "hqslam/core/words.h"

#include <algorithm>
#include <cctype>

#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"

namespace hqslam {

namespace {

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// Takes the number off the front of `text`, without its leading zeros.
std::string_view take_number(std::string_view& text) {
  std::size_t end = 0;
  while (end < text.size() && is_digit(text[end])) ++end;
  std::string_view number = text.substr(0, end);
  text.remove_prefix(end);
  while (number.size() > 1 && number[0] == '0') number.remove_prefix(1);
  return number;
}

}  // namespace

std::vector<std::string_view> words_of(std::string_view line, std::string_view separators,
                                       std::size_t most) {
  std::vector<std::string_view> words;
  while (words.size() < most) {
    const std::size_t begin = line.find_first_not_of(separators);
    if (begin == std::string_view::npos) break;
    const std::size_t end = std::min(line.find_first_of(separators, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    line.remove_prefix(end);
  }
  return words;
}

std::string_view next_line(std::string_view& rest) {
  const std::string_view line = rest.substr(0, rest.find('\n'));
  rest.remove_prefix(std::min(line.size() + 1, rest.size()));
  return line;
}

AsciiPoints::AsciiPoints(std::string_view text, std::size_t points, std::size_t numbers_per_point,
                         const std::string& path)
    : rest_(text), points_(points), path_(path) {
  // Each number takes a character and a separator.
  if (points > text.size() || points * numbers_per_point > (text.size() + 1) / 2) {
    throw Error(
        "{}: truncated: expected {} points of {} numbers, found {} bytes; copy the file again",
        path, points, numbers_per_point, text.size());
  }
  numbers_.resize(numbers_per_point);
}

const std::vector<double>& AsciiPoints::next() {
  constexpr std::string_view kAnySpace = " \t\r\n";
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(kAnySpace), rest_.size()));
    if (rest_.empty()) {
      throw Error(
          "{}: truncated: expected {} points of {} numbers, found {} numbers; copy the file again",
          path_, points_, numbers_.size(), point_ * numbers_.size() + i);
    }
    const std::string_view word = rest_.substr(0, rest_.find_first_of(kAnySpace));
    const std::optional<double> value = number_from<double>(word);
    if (!value) {
      throw Error("{}: point {}: expected a number, found '{}'; correct the line", path_, point_,
                  excerpt(word));
    }
    numbers_[i] = *value;
    rest_.remove_prefix(word.size());
  }
  ++point_;
  return numbers_;
}

bool naturally_before(std::string_view a, std::string_view b) {
  const std::string_view whole_a = a;
  const std::string_view whole_b = b;
  while (!a.empty() && !b.empty()) {
    if (is_digit(a[0]) && is_digit(b[0])) {
      const std::string_view number_a = take_number(a);
      const std::string_view number_b = take_number(b);
      if (number_a.size() != number_b.size()) return number_a.size() < number_b.size();
      if (number_a != number_b) return number_a < number_b;
    } else {
      if (a[0] != b[0]) return a[0] < b[0];
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  if (a.size() != b.size()) return a.size() < b.size();
  return whole_a < whole_b;  // "1" and "01" are different names of one number
}

}  // namespace hqslam
