#pragma once

#include <vector>

#include "hqslam/core/range_image.h"

namespace hqslam::nn {

/// A scan with all rows: those that were measured, and those that were computed from them.
struct LiftedImage {
  RangeImage image;
  /// One per pixel: the probability that there is a return and that it lies within the tolerance
  /// (SuperResolverOptions::tolerance_m) of the image's range; 1 for measured returns, 0 where the
  /// image has none. Empty: the method does not say.
  std::vector<float> confidence;
};

}  // namespace hqslam::nn
