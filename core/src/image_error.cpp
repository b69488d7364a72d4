#include "hqslam/core/image_error.h"

#include <fmt/format.h>

#include <cmath>

#include "hqslam/core/error.h"

namespace hqslam {

ImageError image_error(const RangeImage& image, const RangeImage& true_image) {
  if (image.rows != true_image.rows || image.columns != true_image.columns) {
    throw Error(fmt::format("expected an image of {} x {} pixels as the true one, found {} x {}",
                            true_image.rows, true_image.columns, image.rows, image.columns));
  }
  const auto range_or_zero = [](float range_m) {
    return std::isfinite(range_m) && range_m > 0.0F ? static_cast<double>(range_m) : 0.0;
  };
  ImageError error;
  double sum_m = 0.0;
  double valid_sum_m = 0.0;
  for (std::size_t i = 0; i < image.range_m.size(); ++i) {
    const double range_m = range_or_zero(image.range_m[i]);
    const double true_range_m = range_or_zero(true_image.range_m[i]);
    const double difference_m = std::abs(range_m - true_range_m);
    sum_m += difference_m;
    ++error.pixels;
    if (range_m == 0.0 || true_range_m == 0.0) continue;
    valid_sum_m += difference_m;
    ++error.valid_pixels;
  }
  if (error.pixels > 0) error.mae_all_m = sum_m / static_cast<double>(error.pixels);
  if (error.valid_pixels > 0) {
    error.mae_valid_m = valid_sum_m / static_cast<double>(error.valid_pixels);
  }
  return error;
}

}  // namespace hqslam
