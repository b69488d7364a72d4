#pragma once

#include <Eigen/Core>

#include "hqslam/core/pose.h"

namespace hqslam::slam {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector12 = Eigen::Matrix<double, 12, 1>;
using Matrix12 = Eigen::Matrix<double, 12, 12>;

/// (linear, angular)
Vector6 vector_of(const Twist& twist);
Twist twist_of(const Vector6& vector);
/// What a change of frames does to (linear, angular): exp(adjoint(T) e) = T exp(e) T^-1.
Matrix6 adjoint(const Pose& pose);

/// Where a sensor is and how it moves, and how well both are known.
///
/// The covariance is that of the error e = (pose, velocity) in the sensor's frame,
///   T_true = T_map_sensor exp(e_pose),  velocity_true = velocity + e_velocity,
/// each as (linear, angular): metres, radians, metres a second, radians a second.
struct MotionState {
  Pose T_map_sensor = Pose::Identity();
  Twist velocity;  ///< per second, in the sensor's frame
  Matrix12 covariance = Matrix12::Identity();
};

/// A sensor that was just switched on at a pose that is known: nothing is known about its velocity
/// but what moves on earth.
MotionState unknown_motion(const Pose& T_map_sensor);

/// How much velocities change: power spectral densities of white accelerations, per component
/// ((m/s^2)^2/Hz along x, y, z, (rad/s^2)^2/Hz about them). Over a time t a velocity changes by a
/// random amount of variance density * t.
///
/// Learnt from the drive: what the velocity has changed by from scan to scan lately.
class AccelerationNoise {
 public:
  AccelerationNoise();
  const Vector6& density() const { return density_; }
  /// Two velocities that followed each other within a step.
  void learn(const Twist& before, const Twist& after, double step_s);

 private:
  Vector6 density_;
};

/// The state `duration_s` later, if the velocity stays as it is but for random accelerations.
///
///   T <- T exp(velocity t),   F = [Ad(exp(-velocity t))  t I; 0  I],   P <- F P F^T + Q,
///   Q = density [t^3  t^2; t^2  t].
/// Source: Barfoot, "State Estimation for Robotics", section 11.2 (white noise on acceleration).
/// Differs from it: the velocity changes at the beginning of a step (so t^3, not t^3 / 3), hence is
/// the mean over the step. The velocity at its end would have to be extrapolated, v' = 1.5 step / t
/// - 0.5 v, which rings from scan to scan: a wrong velocity corrects the scan wrongly for motion,
/// that moves the pose, and the next velocity is wrong the other way, by more.
///
/// Nobody keeps a velocity for long. Beyond `steady_s` the expected velocity dies away (time
/// constant 1 s), and what it was is uncertainty from then on.
MotionState predicted(const MotionState& state, double duration_s, double steady_s,
                      const Vector6& density);

/// The same for an acceleration of another kind, that moved the sensor by `innovation` beside where
/// it was expected: as large a one becomes likely.
MotionState with_innovation(const MotionState& expected, const Twist& innovation,
                            double duration_s);

}  // namespace hqslam::slam
