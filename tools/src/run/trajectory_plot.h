#pragma once

#include <string>

#include "run/slam_run.h"

namespace hqslam::tools {

/// The drive from above in the map frame, x to the right and y upwards, both axes in metres and of
/// one scale: the map's points faintly behind, the reference as a dashed line, the estimate
/// coloured by its error where there is a reference. HTML with inline SVG.
std::string trajectory_plot_html(const SlamRun& run);

}  // namespace hqslam::tools
