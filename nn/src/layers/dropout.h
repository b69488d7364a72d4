#pragma once

#include "../random.h"

namespace hqslam::nn {

/// A number from 0 to below 1 for each place, by seed and place alone, so that it does not matter
/// who asks first.
inline float unit_random(std::uint64_t seed, std::uint64_t place) {
  Random random(seed + 0x9E3779B97F4A7C15ULL * place);
  return static_cast<float>(random.bits() >> 40) / static_cast<float>(1 << 24);
}

}  // namespace hqslam::nn
