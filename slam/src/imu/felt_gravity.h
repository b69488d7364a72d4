#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "hqslam/core/trajectory.h"
#include "imu/imu_buffer.h"

namespace hqslam::slam {

/// What an inertial sensor may be off by as long as it is not taken off: its axes turned about the
/// LiDAR's x, y, z (rad), specific forces too long (a share), where it sits in the LiDAR's frame
/// (m), stamps late (s).
using ImuErrors = Eigen::Matrix<double, 8, 1>;

/// Gravity as a sensor would feel it if it did not accelerate, downwards, in its frame, and what a
/// bias b of the accelerometer and its errors m do to it: R^T g = z + L b + M m.
struct FeltGravity {
  double stamp_s = 0.0;
  double sigma_mps2 = 0.01;  ///< of z, by how well poses and forces fit each other
  Eigen::Vector3d gravity_mps2 = Eigen::Vector3d::Zero();                       ///< z
  Eigen::Matrix3d of_bias = Eigen::Matrix3d::Zero();                            ///< L
  Eigen::Matrix<double, 3, 8> of_errors = Eigen::Matrix<double, 3, 8>::Zero();  ///< M
};

/// At the last of some poses. The gyroscope turns every specific force f into that sensor's frame;
/// integrated twice it is s(t), and with the position p(t) in that frame
///   p(t) - s(t) = p_0 + v_0 t + z t^2 / 2
/// is solved for z by least squares; L and M by differences. Three seconds tell the vertical to
/// 0.02 to 0.05 degrees, though a map may lean: p is known up to a turn, which v_0 takes.
///
/// steps: from the first pose to the last, the rates without their bias. Nothing where poses and
/// forces do not fit each other.
std::optional<FeltGravity> felt_gravity(const Trajectory& poses, const std::vector<ImuStep>& steps);

/// The poses of the last scans that were registered one after the other, three seconds of them, and
/// the gyroscope's bias then.
class GravityWindow {
 public:
  void add(const StampedPose& registered, const Eigen::Vector3d& gyroscope_bias_rad_per_s);
  void interrupt() { poses_.clear(); }
  /// The map was moved.
  void correct(const Pose& T_corrected_map);
  /// Gravity at the last pose. Nothing where the window is not full or not all of it was measured.
  /// The next one begins there: windows that overlap would be no new measurements.
  std::optional<FeltGravity> take(const ImuBuffer& imu, const Eigen::Matrix3d& R_level_sensor);

 private:
  Trajectory poses_;
  Eigen::Vector3d gyroscope_bias_rad_per_s_ = Eigen::Vector3d::Zero();
};

}  // namespace hqslam::slam
