#pragma once

#include <string>
#include <vector>

#include "hqslam/nn/training/checkpoint.h"

namespace hqslam::tools {

/// Loss and validation error over the steps as an SVG file's text, with linear interpolation's
/// error as a line to compare with.
std::string learning_curve_svg(const std::vector<nn::CurvePoint>& curve);

}  // namespace hqslam::tools
