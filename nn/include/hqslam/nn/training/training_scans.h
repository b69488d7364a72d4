#pragma once

#include <cstdint>

#include "hqslam/core/range_image.h"

namespace hqslam::nn {

/// The scans that a network is trained on, wherever they are: all of one shape, ranges in metres, 0
/// where nothing returned, never NaN, infinite or negative.
class TrainingScans {
 public:
  virtual ~TrainingScans() = default;
  virtual std::int64_t size() const = 0;
  virtual int rows() const = 0;
  virtual int columns() const = 0;
  /// Scan i, 0 to size() - 1. Many threads may read at once. Throws Error if it cannot be read.
  virtual RangeImage read(std::int64_t i) const = 0;
};

}  // namespace hqslam::nn
