#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "hqslam/core/trajectory.h"
#include "imu/imu_buffer.h"

namespace hqslam::slam {

/// Constant errors of an inertial sensor: rotation of its axes about the LiDAR's x, y, z (rad),
/// scale of the specific force (a share), its position in the LiDAR's frame (m), delay of the
/// stamps (s).
using ImuErrors = Eigen::Matrix<double, 8, 1>;

/// Measured gravity, downwards, in the sensor's frame, as a function of the accelerometer's bias b
/// and the ImuErrors m: R^T g = z + L b + M m.
struct FeltGravity {
  double stamp_s = 0.0;
  double sigma_mps2 = 0.01;  ///< of z, from the residual of poses against forces
  Eigen::Vector3d gravity_mps2 = Eigen::Vector3d::Zero();                       ///< z
  Eigen::Matrix3d of_bias = Eigen::Matrix3d::Zero();                            ///< L
  Eigen::Matrix<double, 3, 8> of_errors = Eigen::Matrix<double, 3, 8>::Zero();  ///< M
};

/// Gravity at the last of several poses. The specific force f, turned by the gyroscope into the
/// frame of the last pose and integrated twice, is s(t); with the position p(t) in that frame
///   p(t) - s(t) = p_0 + v_0 t + z t^2 / 2
/// is solved for z by least squares; L and M by finite differences. Three seconds give the vertical
/// to 0.02 to 0.05 degrees, even in a tilted map: a rotation of p is absorbed by v_0.
///
/// steps: from the first pose to the last, the rates without their bias. Nothing if poses and
/// forces contradict each other.
std::optional<FeltGravity> felt_gravity(const Trajectory& poses, const std::vector<ImuStep>& steps);

/// The poses of the last consecutively registered scans, three seconds of them, and the gyroscope's
/// bias.
class GravityWindow {
 public:
  void add(const StampedPose& registered, const Eigen::Vector3d& gyroscope_bias_rad_per_s);
  void interrupt() { poses_.clear(); }
  void correct(const Pose& T_corrected_map);
  /// Gravity at the last pose; nothing unless the window is full and covered by samples. The next
  /// window begins there: overlapping windows would not be independent.
  std::optional<FeltGravity> take(const ImuBuffer& imu, const Eigen::Matrix3d& R_level_sensor);

 private:
  Trajectory poses_;
  Eigen::Vector3d gyroscope_bias_rad_per_s_ = Eigen::Vector3d::Zero();
};

}  // namespace hqslam::slam
