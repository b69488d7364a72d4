#pragma once

#include "tensor.h"
#include "testing.h"

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

/// Calls visit(channel, row, column) for every value, `border` columns on either side too.
void for_each_value(const Tensor& tensor, int border, const auto& visit) {
  for (int c = 0; c < tensor.channels(); ++c) {
    for (int y = 0; y < tensor.rows(); ++y) {
      for (int x = -border; x < tensor.columns() + border; ++x) visit(c, y, x);
    }
  }
}

/// Random values in a tensor, borders filled.
inline void fill_random(std::uint32_t seed, Tensor& tensor) {
  const std::vector<float> values = random_values(
      seed, static_cast<std::int64_t>(tensor.channels()) * tensor.rows() * tensor.columns());
  const float* next = values.data();
  for_each_value(tensor, 0, [&](int c, int y, int x) { tensor.at(c, y, x) = *next++; });
  tensor.fill_borders();
}

/// As far as float goes, in `border` columns on either side too.
inline void check_close(const Tensor& actual, const Tensor& expected, int border) {
  for_each_value(expected, border, [&](int c, int y, int x) {
    REQUIRE(actual.at(c, y, x) == doctest::Approx(expected.at(c, y, x)).epsilon(1e-5).scale(1));
  });
}

inline bool same_bits(const Tensor& a, const Tensor& b) {
  for (int c = 0; c < a.channels(); ++c) {
    for (int y = 0; y < a.rows(); ++y) {
      if (std::memcmp(a.row(c, y), b.row(c, y), a.columns() * sizeof(float)) != 0) return false;
    }
  }
  return true;
}

/// How `loss` changes with a value that it depends on: central differences.
template <typename Loss, typename Value>
double slope_of(const Loss& loss, Value step, Value& value) {
  const Value before = value;
  value = before + step;
  const double above = loss();
  value = before - step;
  const double below = loss();
  value = before;
  return (above - below) / (2.0 * step);
}

}  // namespace hqslam::nn
