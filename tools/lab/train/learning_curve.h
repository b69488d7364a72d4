#pragma once

#include <string>
#include <vector>

#include "hqslam/nn/training/checkpoint.h"

namespace hqslam::tools {

/// The validation's errors over the steps as an SVG file's text, each as part of linear
/// interpolation's: MAE over all pixels, MAE where both have a return, share of wrong points.
std::string learning_curve_svg(const std::vector<nn::CurvePoint>& curve);

}  // namespace hqslam::tools
