#pragma once

#include <algorithm>
#include <cmath>

#include "hqslam/core/trajectory.h"
#include "slam/yard.h"

namespace hqslam::test {

constexpr double kDrivePeriod_s = 0.1;

/// Around the yard at 5 m/s, with turns: the true pose at a time.
inline Pose drive_pose(double time_s) {
  const double phase = 0.25 * time_s;
  const Eigen::Vector2d p(14.0 * std::sin(phase), 3.0 * std::sin(2.0 * phase));
  const Eigen::Vector2d v(14.0 * std::cos(phase), 6.0 * std::cos(2.0 * phase));
  return yard_pose(p.x(), p.y(), std::atan2(v.y(), v.x()));
}

/// Scan `i` of the drive, captured rolling.
inline OrganizedCloud drive_scan(const SensorModel& sensor, int i) {
  return Yard().rolling_scan(
      sensor, [&](double time_s) { return drive_pose(i * kDrivePeriod_s + time_s); });
}

/// The worst error of a trajectory with all scans of the drive.
inline double worst_error_m(const Trajectory& trajectory) {
  double worst_m = 0.0;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const Pose truth =
        drive_pose(0).inverse() * drive_pose(static_cast<double>(i) * kDrivePeriod_s);
    worst_m =
        std::max(worst_m, (trajectory[i].T_map_sensor.translation() - truth.translation()).norm());
  }
  return worst_m;
}

}  // namespace hqslam::test
