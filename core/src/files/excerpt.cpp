#include "hqslam/core/excerpt.h"

#include <fmt/format.h>

#include <algorithm>

namespace hqslam {

namespace {

bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

/// utf8_bytes, but 0 for characters that steer a terminal.
std::size_t shown_bytes(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  const std::size_t bytes = utf8_bytes(text);
  const bool steers =
      bytes == 1 ? first < 0x20U || first == 0x7FU
                 : bytes == 2 && first == 0xC2U && static_cast<unsigned char>(text[1]) < 0xA0U;
  return steers ? 0 : bytes;
}

std::string escaped(char c) {
  switch (c) {
    case '\n':
      return "\\n";
    case '\r':
      return "\\r";
    case '\t':
      return "\\t";
    default:
      return fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
  }
}

}  // namespace

std::size_t utf8_bytes(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  if (first < 0x80U) return 1;
  const std::size_t bytes = first >= 0xF0U ? 4 : first >= 0xE0U ? 3 : 2;
  if (first < 0xC2U || first > 0xF4U || text.size() < bytes) return 0;
  const std::string_view rest = text.substr(1, bytes - 1);
  return std::ranges::all_of(rest, is_continuation) ? bytes : 0;
}

std::string excerpt(std::string_view text, std::size_t max_characters) {
  std::string result;
  for (std::size_t characters = 0; !text.empty(); ++characters) {
    if (characters == max_characters) return result + "...";
    const std::size_t bytes = shown_bytes(text);
    result += bytes > 0 ? std::string(text.substr(0, bytes)) : escaped(text[0]);
    text.remove_prefix(std::max<std::size_t>(bytes, 1));
  }
  return result;
}

}  // namespace hqslam
