#pragma once

#include <string>

#include "table/seeds_figures.h"

namespace hqslam::tools {

/// table.json: per method what its rows say, and what it did on every drive. Figures that are the
/// same in every run, but for "slam_ms".
std::string seeds_json(const SeedTable& table);

}  // namespace hqslam::tools
