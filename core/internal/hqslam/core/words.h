#pragma once

#include <charconv>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hqslam {

inline constexpr std::string_view kSpace = " \t\r";

/// The first words of a line, at most `most`.
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

/// Whether `a` comes before `b` when numbers inside names count by their value: "scan9" before
/// "scan10".
bool naturally_before(std::string_view a, std::string_view b);

/// Points as text: numbers with any space between them.
class AsciiPoints {
 public:
  /// `text` and `path` must outlive the object. Throws Error if the text is too short.
  AsciiPoints(std::string_view text, std::size_t points, std::size_t numbers_per_point,
              const std::string& path);
  /// The numbers of the next point: all of a file's would take many times its size. Throws Error if
  /// a word is no number, or one that no double holds.
  const std::vector<double>& next();

 private:
  std::string_view rest_;
  std::size_t points_;
  const std::string& path_;
  std::size_t point_ = 0;
  std::vector<double> numbers_;
};

}  // namespace hqslam
