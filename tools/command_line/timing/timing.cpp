#include "timing/timing.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hqslam::tools {

Distribution distribution_of(std::vector<double> values) {
  if (values.empty()) {
    return {};
  }
  std::ranges::sort(values);
  const std::size_t count = values.size();
  const auto rank_95 = static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(count)));
  Distribution result;
  result.median =
      count % 2 == 1 ? values[count / 2] : 0.5 * (values[count / 2 - 1] + values[count / 2]);
  result.p95 = values[rank_95 - 1];
  result.max = values.back();
  result.mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(count);
  return result;
}

}  // namespace hqslam::tools
