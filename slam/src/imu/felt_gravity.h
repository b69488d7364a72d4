#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>
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
  std::size_t scan = 0;  ///< the number of the last pose in the trajectory: GravityWindow
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
/// bias. Windows that have ended keep their data until gravity is taken: before a sensor is proven
/// its bias is unknown, and what it measured then is needed, since the first node is the vertical.
class GravityWindow {
 public:
  void add(const StampedPose& registered, const Eigen::Vector3d& gyroscope_bias_rad_per_s);
  void interrupt() { poses_.clear(); }
  void correct(const Pose& T_corrected_map);
  /// Ends the window at the last pose, that of the scan with this number, if it is full and covered
  /// by samples. The next one begins there: overlapping windows would not be independent.
  void end(std::size_t scan, const ImuBuffer& imu, const Eigen::Matrix3d& R_level_sensor);
  /// Gravity at the end of each window (of the last hundred) since the last call, rising; without
  /// those in which poses and forces contradict each other.
  std::vector<FeltGravity> take();

 private:
  struct Ended {
    std::size_t scan = 0;
    Trajectory poses;
    std::vector<ImuStep> steps;
  };
  Trajectory poses_;
  std::deque<Ended> ended_;
  Eigen::Vector3d gyroscope_bias_rad_per_s_ = Eigen::Vector3d::Zero();
};

}  // namespace hqslam::slam
