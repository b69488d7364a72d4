#include "report/error_color.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hqslam::tools {

int error_color_class(double share) {
  return static_cast<int>(std::min(std::clamp(share, 0.0, 1.0) * kErrorColors, kErrorColors - 1.0));
}

std::string error_color(double share) {
  constexpr std::array<std::array<double, 3>, 4> kStops = {
      {{44, 92, 212}, {146, 66, 196}, {222, 60, 116}, {250, 150, 40}}};
  const double position = std::clamp(share, 0.0, 1.0) * (kStops.size() - 1);
  const auto stop = std::min(kStops.size() - 2, static_cast<std::size_t>(position));
  const double fraction = position - static_cast<double>(stop);
  std::string color = "#";
  for (std::size_t i = 0; i < 3; ++i) {
    const double value = (1.0 - fraction) * kStops[stop][i] + fraction * kStops[stop + 1][i];
    color += fmt::format("{:02x}", std::lround(value));
  }
  return color;
}

std::string error_color_of_class(int color_class) {
  return error_color((color_class + 0.5) / kErrorColors);
}

std::string error_gradient() {
  constexpr int kSteps = 6;
  std::string gradient = error_color(0.0);
  for (int i = 1; i <= kSteps; ++i) gradient += ", " + error_color(1.0 * i / kSteps);
  return gradient;
}

}  // namespace hqslam::tools
