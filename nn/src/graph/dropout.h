#pragma once

#include <memory>

#include "../random.h"
#include "layer.h"

namespace hqslam::nn {

/// A number from 0 to below 1 for each place, by seed and place alone, so that it does not matter
/// who asks first.
inline float unit_random(std::uint64_t seed, std::uint64_t place) {
  Random random(seed + 0x9E3779B97F4A7C15ULL * place);
  return static_cast<float>(random.bits() >> 40) / static_cast<float>(1 << 24);
}

/// With a seed: each value is dropped with a probability of `share`, or else divided by 1 - share.
std::unique_ptr<Layer> make_dropout(float share, const TensorShape& input);

}  // namespace hqslam::nn
