#pragma once

#include <algorithm>
#include <vector>

#include "hqslam/core/trajectory.h"

namespace hqslam::test {

inline std::vector<Pose> poses_of(const Trajectory& trajectory) {
  std::vector<Pose> result;
  for (const StampedPose& pose : trajectory) result.push_back(pose.T_map_sensor);
  return result;
}

/// Of poses in the frame of the first true one, those from `first` on.
inline double worst_error_m(const std::vector<Pose>& poses, const std::vector<Pose>& truth,
                            std::size_t first = 0) {
  double worst_m = 0.0;
  for (std::size_t i = first; i < poses.size(); ++i) {
    const Pose expected = truth.front().inverse() * truth[i];
    worst_m = std::max(worst_m, (poses[i].translation() - expected.translation()).norm());
  }
  return worst_m;
}

}  // namespace hqslam::test
