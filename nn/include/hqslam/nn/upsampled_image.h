#pragma once

#include <vector>

#include "hqslam/core/range_image.h"

namespace hqslam::nn {

/// A scan with all rows: those that were measured, and those that were computed from them.
struct UpsampledImage {
  RangeImage image;
  /// One per pixel: the probability that there is a return and that it lies within the tolerance
  /// (SuperResolverOptions::tolerance_m) of the image's range; 1 for measured returns, 0 where the
  /// image has none. Empty: the method gives none.
  std::vector<float> confidence;
};

/// What other scans measured, as ranges from the present pose: M and W of the term
/// 1/2 |W (M - H)|^2 that they add to eq. 3. Made by ScanMemory.
struct RecalledImage {
  /// M: all rows of the sensor, metres; 0 where nothing is recalled.
  RangeImage image;
  /// W^2 of every pixel, with the penalty 2 b of a pixel that was not measured as its unit: four
  /// times the number of earlier points that agree, each weighted by its distance from the pixel's
  /// centre.
  std::vector<float> weight;

  /// Nothing is recalled at all: the first scan of a drive.
  bool is_empty() const { return image.range_m.empty(); }
};

}  // namespace hqslam::nn
