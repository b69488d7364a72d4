#pragma once

#include <cctype>
#include <string>
#include <string_view>

namespace hqslam {

/// The beginning of a text found in a file, fit for a message of one line.
inline std::string excerpt(std::string_view text) {
  constexpr std::size_t kMaxCharacters = 30;
  std::string result(text.substr(0, kMaxCharacters));
  for (char& c : result) {
    if (!std::isprint(static_cast<unsigned char>(c))) c = '?';
  }
  return text.size() > kMaxCharacters ? result + "..." : result;
}

}  // namespace hqslam
