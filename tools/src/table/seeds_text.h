#pragma once

#include <string>
#include <vector>

#include "table/seeds_figures.h"
#include "table/table_text.h"

namespace hqslam::tools {

/// Drift, slips and APE of every method.
TextTable seeds_summary_table(const SeedTable& table);
/// Every method beside the one that the table pairs with.
TextTable seeds_pair_table(const SeedTable& table);
/// "town: seeds 1, 2, 3; 1000 scans each, 2.7 km"
std::string seeds_text(const SeedTable& table);
/// What the columns mean and how it was measured.
std::vector<std::string> seeds_notes(const SeedTable& table);

/// table.md
std::string seeds_markdown(const SeedTable& table);

}  // namespace hqslam::tools
