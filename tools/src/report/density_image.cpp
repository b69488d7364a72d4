#include "report/density_image.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace hqslam::tools {
namespace {

/// Points per pixel.
std::vector<int> counts_from_above(const std::vector<Eigen::Vector3f>& points_m, const PlotBox& box,
                                   int rows, int columns) {
  std::vector<int> counts(static_cast<std::size_t>(rows) * columns, 0);
  for (const Eigen::Vector3f& point_m : points_m) {
    const double column = to_plot_x(box, point_m.x()) / kPlotUnits * columns;
    const double row = to_plot_y(box, point_m.y()) / kPlotUnits * rows;
    if (row >= 0.0 && row < rows && column >= 0.0 && column < columns) {
      ++counts[static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column)];
    }
  }
  return counts;
}

/// A count that few pixels exceed: the darkest grey stands for it.
int dark_count(std::vector<int> counts) {
  counts.erase(std::remove(counts.begin(), counts.end(), 0), counts.end());
  if (counts.empty()) {
    return 1;
  }
  const auto rank = static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(counts.size() - 1));
  std::nth_element(counts.begin(), counts.begin() + rank, counts.end());
  return std::max(1, counts[static_cast<std::size_t>(rank)]);
}

}  // namespace

RgbImage density_from_above(const std::vector<Eigen::Vector3f>& points_m, const PlotBox& box,
                            int rows, int columns) {
  constexpr double kLevels = 10.0;
  constexpr double kDarkest = 50.0;
  // A lone point, such as the ground is thinned to, is only hinted at: walls and trees count.
  constexpr double kLonePoint = 0.1;
  const std::vector<int> counts = counts_from_above(points_m, box, rows, columns);
  const double full = std::log(std::max(2, dark_count(counts)));
  RgbImage image;
  image.rows = rows;
  image.columns = columns;
  image.pixels.reserve(counts.size());
  for (const int count : counts) {
    const double tone =
        count == 0 ? 0.0 : kLonePoint + (1.0 - kLonePoint) * std::min(1.0, std::log(count) / full);
    const double share = std::round(kLevels * tone) / kLevels;
    const auto grey = static_cast<std::uint8_t>(255.0 - (255.0 - kDarkest) * share);
    image.pixels.push_back({grey, grey, grey});
  }
  return image;
}

std::string base64(const std::vector<std::uint8_t>& bytes) {
  constexpr std::string_view kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t present = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8U | (k < present ? bytes[i + k] : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= present ? kAlphabet[group >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}

}  // namespace hqslam::tools
