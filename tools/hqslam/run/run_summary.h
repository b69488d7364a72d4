#pragma once

#include <string>
#include <vector>

#include "run/slam_run.h"

namespace hqslam::tools {

/// A few lines about a run: scans, path, statuses, what the upsampling took.
std::string run_summary(const SlamRun& run);

/// Of a scan with returns.
double share_on_ground(const slam::ScanReport& report);

/// "only 7 % of the returns; normal in rooms. Elsewhere ..." where a sensor probably is not
/// mounted, or its rows not ordered, as stated; otherwise empty. shares: share_on_ground() of each
/// scan.
std::string complaint_about_ground(const std::vector<double>& shares);

/// A line about each map, then "results: out/trajectory.tum, ..."
std::string results_lines(const SlamRun& run, const std::string& out);

}  // namespace hqslam::tools
