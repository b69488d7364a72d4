#include "hqslam/nn/hqs/interpolation.h"

#include <fmt/format.h>

#include <algorithm>

#include "hqslam/core/error.h"

namespace hqslam::nn {
namespace {

/// Which two rows of the measured image an output row lies between, and where.
struct Between {
  int above = 0;
  int below = 0;
  float part_down = 0.0F;  ///< 0 at `above`, 1 at `below`
};

Between between(int row, RowSelection measured_rows, int measured) {
  const int stride = measured_rows.stride;
  const int last = measured_rows.offset + (measured - 1) * stride;
  if (row <= measured_rows.offset) return {0, 0, 1.0F};
  if (row >= last) return {measured - 1, measured - 1, 1.0F};
  const int above = (row - measured_rows.offset) / stride;
  const int rest = (row - measured_rows.offset) % stride;
  if (rest == 0) return {above, above, 1.0F};
  return {above, above + 1, static_cast<float>(rest) / static_cast<float>(stride)};
}

void check(const RangeImage& measured, RowSelection measured_rows, int rows) {
  const int expected =
      (rows - measured_rows.offset + measured_rows.stride - 1) / std::max(measured_rows.stride, 1);
  if (measured_rows.stride < 1 || measured_rows.offset < 0 || measured_rows.offset >= rows ||
      measured.rows != expected || measured.columns < 1) {
    throw Error(fmt::format(
        "interpolation: an image of {} x {} is not the rows {}, {} + {}, ... of {} rows",
        measured.rows, measured.columns, measured_rows.offset, measured_rows.offset,
        measured_rows.stride, rows));
  }
}

float interpolated(float above_m, float below_m, float part_down, Interpolation interpolation) {
  const float nearest_m = part_down < 0.5F ? above_m : below_m;
  if (interpolation == Interpolation::kNearest || above_m <= 0.0F || below_m <= 0.0F) {
    return nearest_m;
  }
  if (interpolation == Interpolation::kLinear) {
    return (1.0F - part_down) * above_m + part_down * below_m;
  }
  return above_m * below_m / ((1.0F - part_down) * below_m + part_down * above_m);
}

}  // namespace

RangeImage interpolate_rows(const RangeImage& measured, RowSelection measured_rows, int rows,
                            Interpolation interpolation) {
  check(measured, measured_rows, rows);
  RangeImage image(rows, measured.columns);
  for (int row = 0; row < rows; ++row) {
    const Between b = between(row, measured_rows, measured.rows);
    for (int column = 0; column < measured.columns; ++column) {
      const float below_m = measured.at(b.below, column);
      image.at(row, column) =
          b.above == b.below
              ? below_m
              : interpolated(measured.at(b.above, column), below_m, b.part_down, interpolation);
    }
  }
  return image;
}

MeasuredNeighbours measured_neighbours(const RangeImage& measured, RowSelection measured_rows,
                                       int rows) {
  check(measured, measured_rows, rows);
  MeasuredNeighbours neighbours{RangeImage(rows, measured.columns),
                                RangeImage(rows, measured.columns)};
  for (int row = 0; row < rows; ++row) {
    const Between b = between(row, measured_rows, measured.rows);
    const auto copy = [&](int from, RangeImage& to) {
      std::copy_n(&measured.range_m[measured.index(from, 0)], measured.columns,
                  &to.range_m[to.index(row, 0)]);
    };
    copy(b.above, neighbours.above);
    copy(b.below, neighbours.below);
  }
  return neighbours;
}

}  // namespace hqslam::nn
