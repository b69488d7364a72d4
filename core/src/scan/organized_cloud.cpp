#include "hqslam/core/organized_cloud.h"

#include <cmath>

#include "hqslam/core/error.h"

namespace hqslam {

namespace {

/// These rows of a row-major grid with `columns` columns; an empty grid stays empty.
template <typename Value>
std::vector<Value> rows_of(const std::vector<Value>& grid, int columns,
                           const std::vector<int>& rows) {
  std::vector<Value> result;
  if (grid.empty()) return result;
  for (const int row : rows) {
    const auto first = grid.begin() + static_cast<std::ptrdiff_t>(row) * columns;
    result.insert(result.end(), first, first + columns);
  }
  return result;
}

}  // namespace

OrganizedCloud::OrganizedCloud(int rows_, int columns_)
    : rows(rows_),
      columns(columns_),
      points_m(static_cast<std::size_t>(rows_) * columns_, Eigen::Vector3f::Zero()),
      range_m(static_cast<std::size_t>(rows_) * columns_, 0.0F) {}

RangeImage select_rows(const RangeImage& image, RowSelection rows) {
  const std::vector<int> selected = selected_rows(image.rows, rows);
  RangeImage result;
  result.rows = static_cast<int>(selected.size());
  result.columns = image.columns;
  result.range_m = rows_of(image.range_m, image.columns, selected);
  return result;
}

OrganizedCloud select_rows(const OrganizedCloud& cloud, RowSelection rows) {
  const std::vector<int> selected = selected_rows(cloud.rows, rows);
  OrganizedCloud result;
  result.rows = static_cast<int>(selected.size());
  result.columns = cloud.columns;
  result.points_m = rows_of(cloud.points_m, cloud.columns, selected);
  for (const auto values : {&OrganizedCloud::range_m, &OrganizedCloud::time_offset_s,
                            &OrganizedCloud::confidence, &OrganizedCloud::intensity}) {
    result.*values = rows_of(cloud.*values, cloud.columns, selected);
  }
  return result;
}

OrganizedCloud calibrated(OrganizedCloud cloud, const SensorModel& sensor) {
  if (sensor.elevation_correction_rad.empty()) return cloud;
  if (cloud.rows != sensor.rows()) {
    throw Error(
        "a scan of {} rows of a sensor of {}: expected the same rows; name the sensor that "
        "recorded the scan",
        cloud.rows, sensor.rows());
  }
  for (int row = 0; row < cloud.rows; ++row) {
    const double turn_rad = sensor.elevation_correction_rad[row];
    for (int column = 0; column < cloud.columns; ++column) {
      const std::size_t i = cloud.index(row, column);
      if (!(cloud.range_m[i] > 0.0F)) continue;
      const Eigen::Vector3d direction = cloud.points_m[i].cast<double>().normalized();
      const double level = direction.head<2>().norm();
      const double range_m = cloud.range_m[i] + sensor.range_correction_m[row];
      const bool is_return = level > 0.0 && range_m > 0.0;
      const Eigen::Vector3d tilt(-direction.x() * direction.z() / level,
                                 -direction.y() * direction.z() / level, level);
      cloud.range_m[i] = is_return ? static_cast<float>(range_m) : 0.0F;
      cloud.points_m[i].setZero();
      if (!is_return) continue;
      const Eigen::Vector3d turned = std::cos(turn_rad) * direction + std::sin(turn_rad) * tilt;
      cloud.points_m[i] = (range_m * turned).cast<float>();
    }
  }
  return cloud;
}

RangeImage range_image(const OrganizedCloud& cloud) {
  RangeImage image;
  image.rows = cloud.rows;
  image.columns = cloud.columns;
  image.range_m = cloud.range_m;
  return image;
}

std::vector<Eigen::Vector3f> points_of(const OrganizedCloud& cloud) {
  std::vector<Eigen::Vector3f> points_m;
  for (std::size_t i = 0; i < cloud.points_m.size(); ++i) {
    if (cloud.range_m[i] > 0.0F) points_m.push_back(cloud.points_m[i]);
  }
  return points_m;
}

}  // namespace hqslam
