#include "hqslam/nn/interpolation.h"

#include <algorithm>

#include "hqslam/core/error.h"

namespace hqslam::nn {
namespace {

float interpolated(float above_m, float below_m, float part_down, Interpolation interpolation) {
  const float nearest_m = part_down < 0.5F ? above_m : below_m;
  if (interpolation == Interpolation::kNearest || above_m <= 0.0F || below_m <= 0.0F) {
    return nearest_m;
  }
  return above_m * below_m / ((1.0F - part_down) * below_m + part_down * above_m);
}

/// Throws Error unless `measured` holds the measured rows of `rows`.
void check_measured_rows(const RangeImage& measured, RowSelection selection, int rows) {
  const bool selects = selection.stride >= 1 && selection.offset >= 0 && selection.offset < rows;
  if (!selects || measured.rows != measured_row_count(rows, selection) || measured.columns < 1) {
    throw Error("interpolation: an image of {} x {} is not the rows {}, {} + {}, ... of {} rows",
                measured.rows, measured.columns, selection.offset, selection.offset,
                selection.stride, rows);
  }
}

}  // namespace

RowsBetween rows_between(int row, RowSelection measured_rows, int measured) {
  const int stride = measured_rows.stride;
  const int last = measured_rows.offset + (measured - 1) * stride;
  if (row <= measured_rows.offset) return {0, 0, 1.0F};
  if (row >= last) return {measured - 1, measured - 1, 1.0F};
  const int above = (row - measured_rows.offset) / stride;
  const int rest = (row - measured_rows.offset) % stride;
  if (rest == 0) return {above, above, 1.0F};
  return {above, above + 1, static_cast<float>(rest) / static_cast<float>(stride)};
}

RowsBetween rows_between(int row, RowSelection measured_rows,
                         std::span<const double> beam_elevation_rad) {
  const int measured =
      measured_row_count(static_cast<int>(beam_elevation_rad.size()), measured_rows);
  RowsBetween between = rows_between(row, measured_rows, measured);
  if (between.above == between.below) return between;
  const double above_rad =
      beam_elevation_rad[measured_rows.offset + between.above * measured_rows.stride];
  const double below_rad =
      beam_elevation_rad[measured_rows.offset + between.below * measured_rows.stride];
  between.part_down =
      static_cast<float>((above_rad - beam_elevation_rad[row]) / (above_rad - below_rad));
  return between;
}

void interpolate_row(const float* above, const float* below, float part_down,
                     Interpolation interpolation, int columns, float* row) {
  if (interpolation == Interpolation::kLinear) {  // what every upsampling begins with
    const float* nearest = part_down < 0.5F ? above : below;
#pragma omp simd
    for (int x = 0; x < columns; ++x) {
      const float between = (1.0F - part_down) * above[x] + part_down * below[x];
      row[x] = std::min(above[x], below[x]) <= 0.0F ? nearest[x] : between;
    }
    return;
  }
  for (int column = 0; column < columns; ++column) {
    row[column] = interpolated(above[column], below[column], part_down, interpolation);
  }
}

RangeImage interpolate_rows(const RangeImage& measured, RowSelection measured_rows,
                            std::span<const double> beam_elevation_rad,
                            Interpolation interpolation) {
  const auto rows = static_cast<int>(beam_elevation_rad.size());
  check_measured_rows(measured, measured_rows, rows);
  RangeImage image(rows, measured.columns);
  for (int row = 0; row < rows; ++row) {
    const RowsBetween between = interpolation == Interpolation::kInverse
                                    ? rows_between(row, measured_rows, beam_elevation_rad)
                                    : rows_between(row, measured_rows, measured.rows);
    const float* above = &measured.range_m[measured.index(between.above, 0)];
    const float* below = &measured.range_m[measured.index(between.below, 0)];
    float* to = &image.range_m[image.index(row, 0)];
    if (between.above == between.below) {
      std::copy_n(below, measured.columns, to);
    } else {
      interpolate_row(above, below, between.part_down, interpolation, measured.columns, to);
    }
  }
  return image;
}

}  // namespace hqslam::nn
