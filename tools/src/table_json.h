#pragma once

#include <string>
#include <vector>

#include "table_figures.h"

namespace hqslam::tools {

/// table.json: {"drives": figures that are the same in every run, "timings": those that are not}.
std::string table_json(const std::vector<DriveFigures>& drives);

}  // namespace hqslam::tools
