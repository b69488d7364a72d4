#pragma once

#include <cstddef>
#include <vector>

#include "hqslam/core/sensor_model.h"

namespace hqslam {

/// Ranges in metres on a grid of rows (row 0 the highest beam) and columns (see SensorModel).
/// 0 m means no return. Row-major.
struct RangeImage {
  int rows = 0;
  int columns = 0;
  std::vector<float> range_m;

  RangeImage() = default;
  RangeImage(int rows_, int columns_)
      : rows(rows_), columns(columns_), range_m(static_cast<std::size_t>(rows_) * columns_, 0.0F) {}

  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * columns + column;
  }
  float& at(int row, int column) { return range_m[index(row, column)]; }
  float at(int row, int column) const { return range_m[index(row, column)]; }
};

RangeImage select_rows(const RangeImage& image, RowSelection rows);

}  // namespace hqslam
