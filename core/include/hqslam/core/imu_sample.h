#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace hqslam {

/// A measurement of an inertial sensor in the frame of the LiDAR: the mean over the time from one
/// sample to the next.
struct ImuSample {
  double stamp_s = 0.0;  ///< the middle of that time, by the clock of the scans
  Eigen::Vector3d angular_rate_rad_per_s = Eigen::Vector3d::Zero();
  /// Acceleration minus gravity: 9.80665 upwards at rest.
  Eigen::Vector3d specific_force_mps2 = Eigen::Vector3d::Zero();
};

constexpr double kGravity_mps2 = 9.80665;

/// Reads lines of seven numbers, separated by commas: stamp, angular rate x, y, z, specific force
/// x, y, z, in the units of ImuSample. A first line of names is skipped. Throws Error with the
/// line, also where stamps do not rise.
std::vector<ImuSample> read_imu_csv(const std::string& path);

}  // namespace hqslam
