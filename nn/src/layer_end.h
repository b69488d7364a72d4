#pragma once

#include "tensor.h"

namespace hqslam::nn {

/// What a layer does with the sums it has computed: result = a(sum + skip), a(v) = max(v, slope v).
///
/// With `activated`, what an activation max(v, negative_slope v) gave, the sums are gradients of it
/// and a is multiplied by its derivative there: the result is the gradient of what went into it.
struct LayerEnd {
  float negative_slope = 1.0F;   ///< 1 linear, 0 ReLU
  const Tensor* skip = nullptr;  ///< of the result's shape; may be the result
  const Tensor* activated = nullptr;
};

}  // namespace hqslam::nn
