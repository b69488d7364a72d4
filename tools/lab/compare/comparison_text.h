#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "compare/upsampling_comparison.h"

namespace hqslam::tools {

/// Tables for a terminal, with a line of definition for each column: ranges, points and voxels of
/// every method.
std::string scores_text(const std::vector<UpsamplingScore>& scores);
/// Per method the figures of all three tables.
nlohmann::ordered_json scores_json(const std::vector<UpsamplingScore>& scores);

}  // namespace hqslam::tools
