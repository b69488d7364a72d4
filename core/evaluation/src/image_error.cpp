#include "hqslam/evaluation/image_error.h"

#include <cmath>

#include "hqslam/core/error.h"

namespace hqslam {

ImageError image_error(const RangeImage& image, const RangeImage& true_image) {
  if (image.rows != true_image.rows || image.columns != true_image.columns) {
    throw Error("expected an image of {} x {} pixels as the true one, found {} x {}",
                true_image.rows, true_image.columns, image.rows, image.columns);
  }
  const auto range_or_zero = [](float range_m) {
    return std::isfinite(range_m) && range_m > 0.0F ? static_cast<double>(range_m) : 0.0;
  };
  ImageError error;
  double sum_m = 0.0;
  double valid_sum_m = 0.0;
  std::int64_t returns = 0;
  std::int64_t true_returns = 0;
  std::int64_t right = 0;
  for (std::size_t i = 0; i < image.range_m.size(); ++i) {
    const double range_m = range_or_zero(image.range_m[i]);
    const double true_range_m = range_or_zero(true_image.range_m[i]);
    const double difference_m = std::abs(range_m - true_range_m);
    sum_m += difference_m;
    ++error.pixels;
    returns += range_m > 0.0 ? 1 : 0;
    true_returns += true_range_m > 0.0 ? 1 : 0;
    if (range_m == 0.0 || true_range_m == 0.0) continue;
    valid_sum_m += difference_m;
    ++error.valid_pixels;
    right += difference_m < kRightRange_m ? 1 : 0;
  }
  if (error.pixels > 0) error.mae_all_m = sum_m / static_cast<double>(error.pixels);
  if (error.valid_pixels > 0) {
    error.mae_valid_m = valid_sum_m / static_cast<double>(error.valid_pixels);
  }
  const auto share = [&](std::int64_t of) {
    return of > 0 ? static_cast<double>(of - error.valid_pixels) / static_cast<double>(of) : 0.0;
  };
  error.missing_share = share(true_returns);
  error.invented_share = share(returns);
  if (true_returns > 0) {
    error.right_share = static_cast<double>(right) / static_cast<double>(true_returns);
  }
  return error;
}

}  // namespace hqslam
