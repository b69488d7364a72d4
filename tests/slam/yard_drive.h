#pragma once

#include "slam/poses.h"
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
  std::vector<Pose> truth;
  for (int i = 0; i < std::ssize(trajectory); ++i) truth.push_back(drive_pose(i * kDrivePeriod_s));
  return worst_error_m(poses_of(trajectory), truth);
}

}  // namespace hqslam::test
