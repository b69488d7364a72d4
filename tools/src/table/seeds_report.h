#pragma once

#include <string>

#include "table/seeds_figures.h"

namespace hqslam::tools {

/// table.html over seeds: a page that needs no other file. Tables, and each method's drift minus
/// the one's that it is paired with: a dot per drive, the mean and its interval.
std::string seeds_html(const SeedTable& table);

}  // namespace hqslam::tools
