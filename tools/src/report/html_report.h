#pragma once

#include <optional>
#include <string>

#include "reference.h"
#include "slam_run.h"

namespace hqslam::tools {

/// report.html: one page that needs no other file and no network. Headline numbers, the trajectory
/// from above, the error over time and the time per stage.
std::string html_report(const SlamRun& run, const std::optional<ReferenceComparison>& comparison);

}  // namespace hqslam::tools
