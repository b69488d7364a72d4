#pragma once

#include <string>

namespace hqslam::tools {

/// Colours of errors on all pages, as so many classes: paths with the same one are drawn as one.
inline constexpr int kErrorColors = 20;
/// The class of an error, `share` 0 (none) to 1 (the largest).
int error_color_class(double share);
/// "#rrggbb" of an error: blue, violet, pink, orange, told apart on white and on black, and by the
/// colour-blind by lightness.
std::string error_color(double share);
/// The same for all errors of a class.
std::string error_color_of_class(int color_class);
/// "#2c5cd4, ..., #fa9628": the colours from none to the largest, for a CSS gradient.
std::string error_gradient();

}  // namespace hqslam::tools
