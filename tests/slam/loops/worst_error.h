#pragma once

#include <algorithm>
#include <vector>

#include "hqslam/core/pose.h"

namespace hqslam::test {

inline double worst_error_m(const std::vector<Pose>& poses, const std::vector<Pose>& truth) {
  double worst_m = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    worst_m = std::max(worst_m, (poses[i].translation() - truth[i].translation()).norm());
  }
  return worst_m;
}

}  // namespace hqslam::test
