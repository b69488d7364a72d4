#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "table/table_text.h"

namespace hqslam::tools {

/// A table under its title; nothing if it has no rows.
std::string titled_table_html(const TextTable& table);
std::string notes_html(const std::vector<std::string>& notes);
/// The whole page. style: what it adds to the reports' and the tables' own.
std::string table_page_html(std::string_view title, std::string_view style,
                            const std::string& body);

}  // namespace hqslam::tools
