#pragma once

#include <string>

#include "run/slam_run.h"

namespace hqslam::tools {

/// covariances.csv: a line per scan, its stamp in seconds, how the mapping located it, and the 6x6
/// covariance of its pose, row after row; before them two lines that say what it is and name the
/// columns.
std::string covariances_csv(const SlamRun& run);

}  // namespace hqslam::tools
