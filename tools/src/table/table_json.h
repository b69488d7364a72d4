#pragma once

#include <string>
#include <vector>

#include "table/table_figures.h"

namespace hqslam::tools {

/// In every table.json: tells one from other files.
inline constexpr const char* kTableJsonMarker = "hqslam table";

/// table.json: {"drives": figures that are the same in every run, "timings": those that are not}.
std::string table_json(const std::vector<DriveFigures>& drives);

}  // namespace hqslam::tools
