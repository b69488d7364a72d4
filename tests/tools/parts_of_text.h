#pragma once

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <string>

#include "error_message.h"

namespace hqslam {

inline bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// How often `part` stands in a text.
inline std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++found;
  }
  return found;
}

/// Whether `call` throws an Error of one line that holds every one of `parts`.
template <typename Call>
bool refuses(std::initializer_list<std::string> parts, const Call& call) {
  const std::string message = test::error_message(call);
  return !holds(message, "\n") &&
         std::all_of(parts.begin(), parts.end(),
                     [&](const std::string& part) { return holds(message, part); });
}

}  // namespace hqslam
