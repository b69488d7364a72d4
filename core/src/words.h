#pragma once

#include <charconv>
#include <limits>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

namespace hqslam {

inline constexpr std::string_view kSpace = " \t\r";

/// The words of a line, at most so many.
std::vector<std::string_view> words_of(std::string_view line, std::string_view separators = kSpace,
                                       std::size_t most = std::numeric_limits<std::size_t>::max());

/// The next line without its end, taken off `rest`, which is not empty.
std::string_view next_line(std::string_view& rest);

/// The number that the whole word is; nothing if it is none or out of range.
template <typename Number>
std::optional<Number> number_from(std::string_view word) {
  Number value{};
  const auto parsed = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool whole = parsed.ec == std::errc() && parsed.ptr == word.data() + word.size();
  return whole ? std::optional(value) : std::nullopt;
}

}  // namespace hqslam
