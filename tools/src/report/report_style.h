#pragma once

#include <string_view>

namespace hqslam::tools {

/// The style sheet of report.html: light and dark, phone and desktop.
extern const std::string_view kReportStyle;

}  // namespace hqslam::tools
