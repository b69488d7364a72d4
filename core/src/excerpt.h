#pragma once

#include <cctype>
#include <string>
#include <string_view>

namespace hqslam {

/// The beginning of a text found in a file, fit for a message of one line.
inline std::string excerpt(std::string_view text, std::size_t max_characters = 30) {
  std::string result(text.substr(0, max_characters));
  for (char& c : result) {
    if (!std::isprint(static_cast<unsigned char>(c))) c = '?';
  }
  return text.size() > max_characters ? result + "..." : result;
}

}  // namespace hqslam
