#pragma once

#include "hqslam/core/range_image.h"

namespace hqslam::nn {

/// What the network sees and what it should say.
struct TrainingSample {
  RangeImage measured;  ///< the measured rows only
  RangeImage truth;     ///< all rows
};

}  // namespace hqslam::nn
