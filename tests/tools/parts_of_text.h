#pragma once

#include <cstddef>

#include "testing.h"

namespace hqslam {

inline bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// The first of these parts that a text does not hold; "" where it holds all of them.
inline std::string missing(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    if (!holds(text, part)) return part;
  }
  return "";
}

/// How often `part` stands in a text.
inline std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++found;
  }
  return found;
}

}  // namespace hqslam
