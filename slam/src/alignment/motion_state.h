#pragma once

#include <Eigen/Core>
#include <optional>

#include "hqslam/core/pose.h"

namespace hqslam::slam {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector12 = Eigen::Matrix<double, 12, 1>;
using Matrix12 = Eigen::Matrix<double, 12, 12>;

inline double distance_m(const Pose& a, const Pose& b) {
  return (a.translation() - b.translation()).norm();
}
/// One value for x, y and z, and one for the rotations about them.
Vector6 six(double linear, double angular);
/// (linear, angular)
Vector6 vector_of(const Twist& twist);
Twist twist_of(const Vector6& vector);
/// The rotation by a rotation vector.
Eigen::Matrix3d rotation_of(const Eigen::Vector3d& turn_rad);
/// The change of (linear, angular) with the frame: exp(adjoint(T) e) = T exp(e) T^-1.
Matrix6 adjoint(const Pose& pose);

/// The motion of a sensor within a scan, in its frame at the stamp.
struct ScanMotion {
  Twist velocity;           ///< at the stamp, per second
  Twist acceleration = {};  ///< per second squared
};

/// Pose and velocity of a sensor with their covariance, that of the error e = (pose, velocity) in
/// the sensor's frame,
///   T_true = T_map_sensor exp(e_pose),  velocity_true = velocity + e_velocity,
/// each as (linear, angular): metres, radians, metres a second, radians a second.
struct MotionState {
  Pose T_map_sensor = Pose::Identity();
  Twist velocity;  ///< per second, in the sensor's frame
  Matrix12 covariance = Matrix12::Identity();
  /// The time since the scan before, where scans measure the velocity, which is then that at the
  /// stamp; otherwise the velocity is the mean over the last step.
  std::optional<double> measured_step_s;
  /// Change of a measured velocity over that time, per second squared; otherwise 0.
  Twist acceleration;

  ScanMotion within_scan() const { return {velocity, acceleration}; }
};

/// A sensor at a known pose whose velocity is unknown, within the limits of vehicles.
MotionState unknown_motion(const Pose& T_map_sensor);

/// Power spectral densities of white accelerations, per component ((m/s^2)^2/Hz along x, y, z,
/// (rad/s^2)^2/Hz about them): over a time t a velocity changes by a random amount of variance
/// density * t. Estimated from recent changes of the velocity from scan to scan.
class AccelerationNoise {
 public:
  AccelerationNoise();
  const Vector6& density() const { return density_; }
  /// In: two successive velocities and the time between them.
  void learn(const Twist& before, const Twist& after, double step_s);

 private:
  Vector6 density_;
};

/// The state `duration_s` later, if the velocity changes only by random accelerations.
///
///   T <- T exp(velocity t),   F = [Ad(exp(-velocity t))  t I; 0  I],   P <- F P F^T + Q,
///   Q = density [t^3  t^2; t^2  t].
/// Source: Barfoot, "State Estimation for Robotics", section 11.2 (white noise on acceleration),
/// Q = density [t^3/3  t^2/2; t^2/2  t], which holds if the next scan measures its velocity itself
/// (measured_step_s, set in the result).
/// Differs from it otherwise: the velocity changes at the beginning of a step, hence is the mean
/// over the step. The velocity at its end would have to be extrapolated, v' = 1.5 step / t - 0.5 v,
/// which oscillates: a wrong velocity corrects the scan wrongly for motion, that moves the pose,
/// and the next velocity is wrong with the opposite sign, by more.
///
/// Beyond `steady_s` the expected velocity decays (time constant 1 s), and the part that has
/// decayed is uncertainty.
MotionState predicted(const MotionState& state, double duration_s, double steady_s,
                      const Vector6& density, bool is_velocity_measured = false);

/// The expected state with a covariance that makes an acceleration plausible that moved the sensor
/// by `innovation` against the expectation.
MotionState with_innovation(const MotionState& expected, const Twist& innovation,
                            double duration_s);

}  // namespace hqslam::slam
