#pragma once

#include <cstdint>

namespace hqslam::nn {

/// A number from 0 to below 1 for each place: splitmix64 of seed and place, so that it does not
/// matter who asks first.
inline float unit_random(std::uint64_t seed, std::uint64_t place) {
  std::uint64_t v = seed + 0x9E3779B97F4A7C15ULL * (place + 1);
  v = (v ^ (v >> 30)) * 0xBF58476D1CE4E5B9ULL;
  v = (v ^ (v >> 27)) * 0x94D049BB133111EBULL;
  return static_cast<float>((v ^ (v >> 31)) >> 40) / static_cast<float>(1 << 24);
}

}  // namespace hqslam::nn
