#include "report/error_color.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "hqslam/evaluation/png.h"

namespace hqslam::tools {

int error_color_class(double share) {
  return static_cast<int>(std::min(std::clamp(share, 0.0, 1.0) * kErrorColors, kErrorColors - 1.0));
}

std::string error_color(double share) {
  constexpr std::array<Rgb, 4> kStops = {
      {{44, 92, 212}, {146, 66, 196}, {222, 60, 116}, {250, 150, 40}}};
  return fmt::format("#{:02x}", fmt::join(color_between(kStops, share), ""));
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
