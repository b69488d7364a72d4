#pragma once

#include <string>
#include <string_view>

namespace hqslam::tools {

/// The style sheet of report.html: light and dark, phone and desktop.
extern const std::string_view kReportStyle;

/// A page in that style that needs no other file. title: as HTML; style: what it adds; head: what
/// else stands in its head.
std::string page_html(std::string_view title, std::string_view style, std::string_view body,
                      std::string_view head = "");

}  // namespace hqslam::tools
