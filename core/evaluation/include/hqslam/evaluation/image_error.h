#pragma once

#include <cstdint>

#include "hqslam/core/range_image.h"

namespace hqslam {

/// Errors of a range image against the true one. Definitions: TULIP (CVPR 2024), evaluation code,
/// in metres here.
struct ImageError {
  double mae_all_m = 0.0;       ///< mean |range - true| over all pixels, no return counting as 0 m
  double mae_valid_m = 0.0;     ///< mean |range - true| over pixels where both have a return
  double missing_share = 0.0;   ///< share of the true returns whose pixel is empty in the image
  double invented_share = 0.0;  ///< share of the image's returns where the true image has none
  double right_share = 0.0;     ///< share of the true returns met within kRightRange_m
  std::int64_t valid_pixels = 0;
  std::int64_t pixels = 0;
};
inline constexpr double kRightRange_m = 0.1;
/// A pixel that is not finite or negative counts as no return. Throws Error if the shapes differ.
ImageError image_error(const RangeImage& image, const RangeImage& true_image);

}  // namespace hqslam
