#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <vector>

namespace hqslam {

inline constexpr double kTwoPi = 2.0 * std::numbers::pi;
inline constexpr double kDegree_rad = std::numbers::pi / 180.0;
inline constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

/// What the constants give but for rounding: 90 is pi / 2 and back to the last digit.
constexpr double radians(double angle_deg) { return angle_deg * std::numbers::pi / 180.0; }
inline std::vector<double> radians(std::vector<double> angles_deg) {
  for (double& angle : angles_deg) angle = radians(angle);
  return angles_deg;
}
constexpr double degrees(double angle_rad) { return angle_rad * 180.0 / std::numbers::pi; }

/// Unit vector in a sensor's frame (x forward, y left, z up).
inline Eigen::Vector3d direction_of(double azimuth_rad, double elevation_rad) {
  return {std::cos(elevation_rad) * std::cos(azimuth_rad),
          std::cos(elevation_rad) * std::sin(azimuth_rad), std::sin(elevation_rad)};
}

}  // namespace hqslam
