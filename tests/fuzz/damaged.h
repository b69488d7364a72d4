#pragma once

#include <algorithm>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

namespace hqslam::test {

/// Bytes that mean something to one parser or another.
inline const std::vector<std::string> kTokens = {
    "\n", " ",     "-",    "0",    "9999999999", "1e308",  "nan",     "inf", "{", "}",
    "[",  "(",     ")",    "'",    "\"",         ",",      ":",       "#",   "x", "\r",
    "-1", "1e999", "null", "true", "DATA ",      "COUNT ", "POINTS ", "F",   "U", "True"};

/// The same bytes with one to four edits.
inline std::string damaged(std::string bytes, std::mt19937& random) {
  const auto below = [&](std::size_t count) { return count == 0 ? 0 : random() % count; };
  const std::size_t edits = 1 + below(4);
  for (std::size_t edit = 0; edit < edits; ++edit) {
    const std::size_t at = below(bytes.size() + 1);
    const std::size_t length = below(std::min<std::size_t>(bytes.size() - at, 40) + 1);
    switch (below(6)) {
      case 0:
        if (at < bytes.size()) bytes[at] = static_cast<char>(random());
        break;
      case 1:
        if (at < bytes.size()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 2:
        bytes.resize(at);
        break;
      case 3:
        bytes.erase(at, length);
        break;
      case 4:
        bytes.insert(at, bytes.substr(at, length));
        break;
      default:
        bytes.replace(at, std::min<std::size_t>(length, below(3)), kTokens[below(kTokens.size())]);
    }
  }
  return bytes;
}

}  // namespace hqslam::test
