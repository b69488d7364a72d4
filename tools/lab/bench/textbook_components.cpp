#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include "bench/bench_measurement.h"

namespace hqslam::tools {
namespace {

using Pixel = std::pair<int, int>;  // row, column

bool connected(const RangeImage& image, const SensorModel& sensor, Pixel a, Pixel b,
               double min_angle_rad) {
  const double range_a_m = image.at(a.first, a.second);
  const double range_b_m = image.at(b.first, b.second);
  if (range_b_m <= 0.0) return false;
  const double alpha_rad =
      a.first == b.first
          ? sensor.column_step_rad()
          : std::abs(sensor.beam_elevation_rad[a.first] - sensor.beam_elevation_rad[b.first]);
  const double farther_m = std::max(range_a_m, range_b_m);
  const double nearer_m = std::min(range_a_m, range_b_m);
  const double angle_rad =
      std::atan2(nearer_m * std::sin(alpha_rad), farther_m - nearer_m * std::cos(alpha_rad));
  return angle_rad > min_angle_rad;
}

std::vector<Pixel> neighbours(const RangeImage& image, Pixel pixel) {
  const auto [row, column] = pixel;
  std::vector<Pixel> result = {{row, (column + 1) % image.columns},
                               {row, (column + image.columns - 1) % image.columns}};
  if (row > 0) result.emplace_back(row - 1, column);
  if (row + 1 < image.rows) result.emplace_back(row + 1, column);
  return result;
}

}  // namespace

std::vector<std::int32_t> textbook_components(const RangeImage& image, const SensorModel& sensor,
                                              double min_angle_rad) {
  std::vector<std::int32_t> label(image.range_m.size(), -1);
  std::int32_t next_label = 0;
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.columns; ++column) {
      if (!image.has_return(row, column) || label[image.index(row, column)] >= 0) continue;
      std::queue<Pixel> queue;
      queue.emplace(row, column);
      label[image.index(row, column)] = next_label;
      while (!queue.empty()) {
        const Pixel pixel = queue.front();
        queue.pop();
        for (const Pixel& other : neighbours(image, pixel)) {
          std::int32_t& other_label = label[image.index(other.first, other.second)];
          if (other_label < 0 && connected(image, sensor, pixel, other, min_angle_rad)) {
            other_label = next_label;
            queue.push(other);
          }
        }
      }
      ++next_label;
    }
  }
  return label;
}

}  // namespace hqslam::tools
