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

/// The one of which so large a share of the others is smaller; there is at least one. Puts them in
/// another order.
template <typename Value>
Value quantile(std::vector<Value>& values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace hqslam
