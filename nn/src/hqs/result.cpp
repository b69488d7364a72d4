#include "hqslam/nn/hqs/result.h"

#include <algorithm>

namespace hqslam::nn {

RangeImage restored_image(const NetworkDescription& description, TileSize tile, const Tensor& z,
                          const RangeImage& measured) {
  RangeImage image(z.rows() * tile.rows, z.columns() * tile.columns);
  from_tiles(z, tile, image.range_m.data());
  const auto nearest_m = static_cast<float>(description.sensor.min_range_m);
  const auto farthest_m = static_cast<float>(description.sensor.max_range_m);
  for (float& range_m : image.range_m) {
    range_m *= description.range_scale_m;
    if (!(range_m >= nearest_m && range_m <= farthest_m)) range_m = 0.0F;
  }
  for (int row = 0; row < measured.rows; ++row) {
    const int to = description.measured_rows.offset + row * description.measured_rows.stride;
    std::copy_n(&measured.range_m[measured.index(row, 0)], measured.columns,
                &image.range_m[image.index(to, 0)]);
  }
  return image;
}

}  // namespace hqslam::nn
