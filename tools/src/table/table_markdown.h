#pragma once

#include <string>
#include <vector>

#include "table/table_figures.h"
#include "table/table_text.h"

namespace hqslam::tools {

std::string markdown_of(const TextTable& table);

/// table.md
std::string table_markdown(const std::vector<DriveFigures>& drives);

}  // namespace hqslam::tools
