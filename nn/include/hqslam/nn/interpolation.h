#pragma once

#include <span>

#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::nn {

/// How a row between two measured ones is filled from them, column by column. With u and d the
/// nearest measured ranges above and below and t the row's place between them (0 above, 1 below):
/// - kNearest: u for t < 1/2, otherwise d;
/// - kLinear: (1 - t) u + t d;
/// - kInverse: linear in 1 / range, 1 / ((1 - t) / u + t / d), t by the elevations of the beams
///   instead of by counting rows. On a plane 1 / range is a sine of the elevation, so between beams
///   a step apart (rad) this errs by at most step^2 / 8 of the range.
/// Where only one of the two has a return, the nearer row decides (as kNearest): a mean with "no
/// return" would be a range that nothing has. Rows beyond the outermost measured ones repeat them.
enum class Interpolation { kNearest, kLinear, kInverse };

/// An image with a row per beam whose measured rows are those of `measured`, from top to bottom.
/// beam_elevation_rad: of every row of the result, falling. Throws Error if there are not as many
/// measured rows.
RangeImage interpolate_rows(const RangeImage& measured, RowSelection measured_rows,
                            std::span<const double> beam_elevation_rad,
                            Interpolation interpolation);

/// The number of measured rows among `rows`; stride 1 or more.
inline int measured_row_count(int rows, RowSelection measured_rows) {
  return (rows - measured_rows.offset + measured_rows.stride - 1) / measured_rows.stride;
}

/// The rows of a measured image between which an output row is, and its place between them. In a
/// measured row, and beyond the outermost ones, both are that row.
struct RowsBetween {
  int above = 0;
  int below = 0;
  float part_down = 1.0F;  ///< 0 at `above`, 1 at `below`
};
/// part_down counts rows.
RowsBetween rows_between(int row, RowSelection measured_rows, int measured);
/// part_down is that of the elevations of the beams.
RowsBetween rows_between(int row, RowSelection measured_rows,
                         std::span<const double> beam_elevation_rad);

/// One row of interpolate_rows, `columns` values from those of the two rows. Any unit.
void interpolate_row(const float* above, const float* below, float part_down,
                     Interpolation interpolation, int columns, float* row);

}  // namespace hqslam::nn
