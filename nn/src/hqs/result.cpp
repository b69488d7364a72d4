#include "result.h"

#include <algorithm>

namespace hqslam::nn {

void restore_rows(const NetworkDescription& description, TileSize tile, const Tensor& z,
                  const RangeImage& measured, RangeImage& image) {
  const RowSelection rows = description.measured_rows;
  const auto nearest_m = static_cast<float>(description.sensor.min_range_m);
  const auto farthest_m = static_cast<float>(description.sensor.max_range_m);
#pragma omp for schedule(static)
  for (int row = 0; row < image.rows; ++row) {
    float* to = &image.range_m[image.index(row, 0)];
    if (rows.contains(row)) {
      const int from = (row - rows.offset) / rows.stride;
      std::copy_n(&measured.range_m[measured.index(from, 0)], measured.columns, to);
      continue;
    }
    take_image_row(z, tile, row, to);
#pragma omp simd
    for (int column = 0; column < image.columns; ++column) {
      const float range_m = to[column] * description.range_scale_m;
      const float not_too_far_m = range_m <= farthest_m ? range_m : 0.0F;
      to[column] = not_too_far_m >= nearest_m ? not_too_far_m : 0.0F;
    }
  }
}

}  // namespace hqslam::nn
