#pragma once

#include <string>
#include <string_view>

namespace hqslam::tools {

/// A page in the style of all reports, for light and dark, phone and desktop, that needs no other
/// file. title: as HTML; style: what it adds; head: what else stands in its head.
std::string page_html(std::string_view title, std::string_view style, std::string_view body,
                      std::string_view head = "");

}  // namespace hqslam::tools
