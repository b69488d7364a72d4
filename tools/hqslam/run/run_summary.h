#pragma once

#include <string>

#include "run/slam_run.h"

namespace hqslam::tools {

/// A few lines about a run: scans, path, statuses, what the upsampling took.
std::string run_summary(const SlamRun& run);

/// A line about each map, then "results: out/trajectory.tum, ..."
std::string results_lines(const SlamRun& run, const std::string& out);

}  // namespace hqslam::tools
