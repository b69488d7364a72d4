#pragma once

#include "hqslam/core/trajectory.h"
#include "testing.h"

namespace hqslam::test {

inline Pose at_x(double x_m) { return pose_from_xyz_rpy({x_m, 0.0, 0.0}, 0.0, 0.0, 0.0); }

inline std::vector<Pose> poses_of(const Trajectory& trajectory) {
  std::vector<Pose> result;
  for (const StampedPose& pose : trajectory) result.push_back(pose.T_map_sensor);
  return result;
}

/// To the last bit.
inline bool are_same(const std::vector<Pose>& a, const std::vector<Pose>& b) {
  return std::ranges::equal(a, b,
                            [](const Pose& p, const Pose& q) { return p.matrix() == q.matrix(); });
}
inline bool are_same(const Trajectory& a, const Trajectory& b) {
  return are_same(poses_of(a), poses_of(b));
}

/// The worst error of poses in the frame of the first true one, from `first` on.
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
