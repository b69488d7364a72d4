#pragma once

#include <doctest/doctest.h>

#include <cstdlib>
#include <optional>
#include <string>

namespace hqslam::test {

/// The path of a file of real data; nothing, and a message, where $HQSLAM_DATA is not set.
inline std::optional<std::string> real_data(const std::string& name) {
  const char* folder = std::getenv("HQSLAM_DATA");
  if (folder == nullptr) {
    MESSAGE("skipped: HQSLAM_DATA is not set, " << name << " is not there");
    return std::nullopt;
  }
  return std::string(folder) + "/" + name;
}

}  // namespace hqslam::test
