#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "recording/reference.h"
#include "run/slam_run.h"

namespace hqslam::tools {

/// The drive from above in the map frame, x to the right and y upwards, both axes in metres and of
/// one scale: the map's points faintly behind, the reference as a dashed line, the estimate
/// coloured by its error where there is a reference. HTML with inline SVG.
std::string trajectory_plot_html(const SlamRun& run,
                                 const std::optional<ReferenceComparison>& comparison);

/// Colour of an error, `share` 0 (none) to 1 (the largest).
std::array<std::uint8_t, 3> error_rgb(double share);
/// The same as "#rrggbb".
std::string error_color(double share);

}  // namespace hqslam::tools
