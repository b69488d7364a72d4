#include "hqslam/core/organized_cloud.h"

#include <algorithm>

namespace hqslam {

namespace {

/// The selected rows of a row-major grid with `columns` columns; an empty grid stays empty.
template <typename Value>
std::vector<Value> selected_rows(const std::vector<Value>& grid, int rows, int columns,
                                 RowSelection selection) {
  std::vector<Value> result;
  if (grid.empty()) return result;
  for (int row = selection.offset; row < rows; row += selection.stride) {
    const auto first = grid.begin() + static_cast<std::ptrdiff_t>(row) * columns;
    result.insert(result.end(), first, first + columns);
  }
  return result;
}

int selected_count(int rows, RowSelection selection) {
  return (rows - selection.offset + selection.stride - 1) / selection.stride;
}

}  // namespace

OrganizedCloud::OrganizedCloud(int rows_, int columns_)
    : rows(rows_),
      columns(columns_),
      points_m(static_cast<std::size_t>(rows_) * columns_, Eigen::Vector3f::Zero()),
      range_m(static_cast<std::size_t>(rows_) * columns_, 0.0F) {}

RangeImage select_rows(const RangeImage& image, RowSelection rows) {
  RangeImage result;
  result.rows = selected_count(image.rows, rows);
  result.columns = image.columns;
  result.range_m = selected_rows(image.range_m, image.rows, image.columns, rows);
  return result;
}

OrganizedCloud select_rows(const OrganizedCloud& cloud, RowSelection rows) {
  OrganizedCloud result;
  result.rows = selected_count(cloud.rows, rows);
  result.columns = cloud.columns;
  result.points_m = selected_rows(cloud.points_m, cloud.rows, cloud.columns, rows);
  result.range_m = selected_rows(cloud.range_m, cloud.rows, cloud.columns, rows);
  result.time_offset_s = selected_rows(cloud.time_offset_s, cloud.rows, cloud.columns, rows);
  return result;
}

RangeImage range_image(const OrganizedCloud& cloud) {
  RangeImage image;
  image.rows = cloud.rows;
  image.columns = cloud.columns;
  image.range_m = cloud.range_m;
  return image;
}

}  // namespace hqslam
