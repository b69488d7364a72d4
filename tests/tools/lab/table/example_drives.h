#pragma once

#include "table/table_run.h"
#include "testing.h"

namespace hqslam::test {

/// 40 poses, 10 m apart on a half circle, moved up by `bump_m` at every second one.
inline Trajectory bumpy_half_circle(double bump_m) {
  Trajectory trajectory;
  for (int i = 0; i < 40; ++i) {
    const double angle_rad = 3.14159265358979 * i / 39.0;
    trajectory.push_back({0.1 * i, Pose(Eigen::Translation3d(124.0 * std::cos(angle_rad),
                                                             124.0 * std::sin(angle_rad),
                                                             i % 2 == 0 ? bump_m : -bump_m))});
  }
  return trajectory;
}

/// `scans` poses a metre apart along x, `scale` times that, with a jump aside before scan `jump`.
inline Trajectory straight_drive(double scale, int scans = 300, int jump = 300) {
  Trajectory trajectory;
  for (int i = 0; i < scans; ++i) {
    trajectory.push_back(
        {0.1 * i, Pose(Eigen::Translation3d(scale * i, i >= jump ? 0.5 : 0.0, 0.0))});
  }
  return trajectory;
}

/// A simulated drive of that kind from that seed with these trajectories.
inline tools::FinishedDrive finished_drive(const std::string& kind, std::uint64_t seed,
                                           std::vector<Trajectory> trajectories,
                                           std::optional<Trajectory> truth) {
  return {{kind, {}, sim::DriveSpec{kind, seed, 200, {}, {}}},
          std::ssize(trajectories.front()),
          std::move(trajectories),
          std::move(truth)};
}

/// LiDAR-16, linear and LiDAR-64; others are paired with linear.
inline tools::TablePlan example_plan(bool over_seeds) {
  const auto& all = tools::table_methods();
  return {{}, over_seeds, {all[0], all[2], all.back()}, 1, std::nullopt, ""};
}

/// LiDAR-16 drifts by 2.5 % and 2 %, linear by 2 % and 1 %, LiDAR-64 by 1 % and 0.5 %, on a drive
/// each of two kinds; on the second LiDAR-16 slips once.
inline std::vector<tools::FinishedDrive> example_drives() {
  const Trajectory truth = straight_drive(1.0);
  return {
      finished_drive("town", 4, {straight_drive(1.025), straight_drive(1.02), straight_drive(1.01)},
                     truth),
      finished_drive("<hills>", 5,
                     {straight_drive(1.02, 300, 150), straight_drive(1.01), straight_drive(1.005)},
                     truth)};
}

}  // namespace hqslam::test
