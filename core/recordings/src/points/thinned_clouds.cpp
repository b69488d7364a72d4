#include "points/thinned_clouds.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>

namespace hqslam::recordings {

namespace {

/// mean_column_step() of clouds that were thinned out so far that single points look like fog.
/// Every second point does no harm.
constexpr double kThinned = 2.9;

/// From a return to the next one of its row, gaps of more than 10 columns left out: 1 for whole
/// scans, more for clouds that were thinned out. 1 without returns.
double mean_column_step(const OrganizedCloud& cloud) {
  constexpr int kLargestGap = 10;
  std::int64_t columns = 0;
  std::int64_t steps = 0;
  for (int row = 0; row < cloud.rows; ++row) {
    int last = -kLargestGap - 1;
    for (int column = 0; column < cloud.columns; ++column) {
      if (!(cloud.range_m[cloud.index(row, column)] > 0.0F)) continue;
      if (column - last <= kLargestGap) {
        columns += column - last;
        ++steps;
      }
      last = column;
    }
  }
  return steps == 0 ? 1.0 : static_cast<double>(columns) / static_cast<double>(steps);
}

}  // namespace

std::string fit_columns(const OrganizedCloud& first, const std::string& name, SensorModel& sensor) {
  const double step = mean_column_step(first);
  if (step <= kThinned) return "";
  sensor.columns /= static_cast<int>(std::lround(step));
  return fmt::format(
      "{}: the points of a row are {:.1f} columns apart: thinned out, and read with {} columns",
      name, step, sensor.columns);
}

}  // namespace hqslam::recordings
