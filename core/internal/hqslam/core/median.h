#pragma once

#include <algorithm>
#include <vector>

namespace hqslam {

/// The middle one of `values`, of an even number the upper of two; there is at least one.
template <typename Value>
Value median(std::vector<Value> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace hqslam
