#pragma once

#include <string>
#include <vector>

#include "pages/text_table.h"

namespace hqslam::tools {

/// A table for a terminal, without its title: every column is as wide as its widest cell or the
/// longest word of its name, and long names are wrapped.
std::string printed_table(const TextTable& table);

/// What a column of a table means.
struct ColumnDefinition {
  const char* column;
  const char* text;  ///< one line, with the unit
};
/// A line for each, the texts below each other.
std::string printed_definitions(const std::vector<ColumnDefinition>& definitions);

}  // namespace hqslam::tools
