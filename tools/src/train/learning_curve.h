#pragma once

#include <string>
#include <vector>

#include "hqslam/nn/training/checkpoint.h"

namespace hqslam::tools {

/// Loss and validation error over the steps as one SVG file, with linear interpolation's error as a
/// line to compare with. Throws Error.
void write_learning_curve(const std::vector<nn::CurvePoint>& curve, const std::string& path);

/// The file's text.
std::string learning_curve_svg(const std::vector<nn::CurvePoint>& curve);

}  // namespace hqslam::tools
