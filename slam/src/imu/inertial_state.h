#pragma once

#include <Eigen/Core>
#include <vector>

#include "alignment/motion_state.h"
#include "imu/imu_buffer.h"

namespace hqslam::slam {

using Matrix18 = Eigen::Matrix<double, 18, 18>;

/// The state of an inertial prediction, beside a MotionState: biases of the sensor and gravity.
///
/// The covariance is that of the errors, in this order: pose (linear, angular) and linear velocity
/// as in MotionState, biases of gyroscope and accelerometer, gravity.
struct InertialState {
  Eigen::Vector3d gyroscope_bias_rad_per_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d accelerometer_bias_mps2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d gravity_map_mps2 = Eigen::Vector3d::Zero();  ///< downwards
  Matrix18 covariance = Matrix18::Zero();
};

/// The state at the first scan: no biases, gravity opposite to the mean specific force of a sensor
/// that hardly accelerates.
InertialState first_inertial_state(const MotionState& state,
                                   const Eigen::Vector3d& specific_force_mps2);

struct InertialPrediction {
  MotionState state;
  InertialState inertial;
};

/// The state after the steps, integrated. With the velocity v in the sensor's frame, the angular
/// rate w and the specific force f, both without bias, the pose T = (R, p) and gravity g:
///
///   R' = R [w],  p' = R v,  v' = f + R^T g - w x v.
///
/// Errors e = (pose, v, gyroscope, accelerometer, gravity) grow as P <- F P F^T + Q with
/// F = I + A t + (A t)^2 / 2 and the rows of A
///
///   linear    -[w]  -[v]     I     0     0   0
///   angular     0   -[w]     0    -I     0   0
///   velocity    0  [R^T g] -[w]  -[v]   -I  R^T
///
/// Source: Forster et al., "On-manifold preintegration for real-time visual-inertial odometry", TRO
/// 2017, for the motion; the errors are those of MotionState.
/// mean_rate_rad_per_s: over the scan that the state is of (EvenTurning), which is its angular
/// velocity.
InertialPrediction predicted(const MotionState& state, const InertialState& inertial,
                             const std::vector<ImuStep>& steps,
                             const Eigen::Vector3d& mean_rate_rad_per_s);

/// Updates biases and gravity by the scan that changed the predicted state to `found`. With the
/// covariance P of the prediction's pose, its rows P_all of all errors, the scan's own information
/// L (`of_scan`, as ScanInformation), the covariance C of `found`, which combines both, and the
/// motion e from the prediction to it, C^-1 e = L z for the pose z by the scan alone. Where errors
/// of normals explain a part of L, C is larger (known_information), and C^-1 e is less than L z:
/// such a direction corrects less. The Kalman update by z with covariance L^-1 + N is
///   A(L) = (I + L (P + N))^-1,  x <- x + P_all A(L) C^-1 e,  P <- P - P_all A(K) K P_all^T,
/// without L^-1: a direction without information changes nothing. N is the covariance of a
/// registration's errors beyond its own estimate. K is the information that is `known` of L: a
/// scan that sees no floor moves in height by errors of normals, and the covariance must grow.
/// Pose and velocity remain as in `found`.
InertialState corrected(const InertialPrediction& prediction, const MotionState& found,
                        const Matrix6& of_scan, const Matrix6& known);

/// The squared innovation of a scan over its covariance, with the symbols of corrected(): for right
/// data about 6. In y = L z, of covariance L + L (P + N) L, directions without information count
/// nothing.
double normalized_innovation(const InertialPrediction& prediction, const MotionState& found,
                             const Matrix6& of_scan);

/// Applies a rotation of the map.
void turn(InertialState& inertial, const Eigen::Matrix3d& R_corrected_map);

/// Sets the gyroscope's bias to the mean difference from turns registered without it, over this
/// time, with the variance of that.
void set_gyroscope_bias(InertialState& inertial, const Eigen::Vector3d& bias_rad_per_s,
                        double duration_s);

/// The biases and gravity unchanged, after an interval without integration.
InertialState kept(const InertialState& inertial, const MotionState& found);

}  // namespace hqslam::slam
