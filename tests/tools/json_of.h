#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "file_contents.h"

namespace hqslam::test {

inline nlohmann::json json_of(const std::string& path) {
  return nlohmann::json::parse(file_contents(path));
}

}  // namespace hqslam::test
