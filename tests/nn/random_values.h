#pragma once

#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "tensor.h"

namespace hqslam::nn {

/// Values in [-1, 1), the same on every machine.
inline std::vector<float> random_values(std::uint32_t seed, std::int64_t count) {
  std::mt19937 generator(seed);
  std::vector<float> values(count);
  for (float& value : values) {
    value = static_cast<float>(generator() >> 8) / static_cast<float>(1 << 23) - 1.0F;
  }
  return values;
}

/// The same for a tensor, borders filled.
inline void fill_random(std::uint32_t seed, Tensor& tensor) {
  const std::vector<float> values = random_values(
      seed, static_cast<std::int64_t>(tensor.channels()) * tensor.rows() * tensor.columns());
  const float* next = values.data();
  for (int c = 0; c < tensor.channels(); ++c) {
    for (int y = 0; y < tensor.rows(); ++y) {
      for (int x = 0; x < tensor.columns(); ++x) tensor.at(c, y, x) = *next++;
    }
  }
  tensor.fill_borders();
}

inline bool same_bits(const Tensor& a, const Tensor& b) {
  for (int c = 0; c < a.channels(); ++c) {
    for (int y = 0; y < a.rows(); ++y) {
      if (std::memcmp(a.row(c, y), b.row(c, y), a.columns() * sizeof(float)) != 0) return false;
    }
  }
  return true;
}

}  // namespace hqslam::nn
