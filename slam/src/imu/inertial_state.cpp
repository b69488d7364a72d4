#include "imu/inertial_state.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "alignment/rotation_derivatives.h"
#include "hqslam/core/imu_sample.h"

namespace hqslam::slam {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Offsets of the errors.
constexpr int kLinear = 0;
constexpr int kAngular = 3;
constexpr int kVelocity = 6;
constexpr int kGyroscope = 9;
constexpr int kAccelerometer = 12;
constexpr int kGravity = 15;

// Initial standard deviations, and densities of noise. Those of noise are several times those of
// data sheets, because of errors of the stamps, samples that are means, and vibration between
// samples.
constexpr double kFirstGyroscopeBias_rad_per_s = 0.02;
constexpr double kFirstAccelerometerBias_mps2 = 0.2;
constexpr double kFirstGravity_mps2 = 1.0;
constexpr double kGyroscopeNoise = 1e-3;      // rad/s/rtHz
constexpr double kAccelerometerNoise = 5e-2;  // m/s^2/rtHz
constexpr double kGyroscopeWalk = 1e-4;       // rad/s^2/rtHz
constexpr double kAccelerometerWalk = 3e-3;   // m/s^3/rtHz
/// Standard deviations of a registration's errors beyond its own estimate: errors of neighbours and
/// of the map are correlated. They make biases and gravity change slowly: the first scans of a
/// drive, in a map of few, are often wrong with a small covariance. Chosen on simulated drives
/// alone.
constexpr double kRegistration_m = 0.02;
constexpr double kRegistration_rad = 4e-3;

void add_variance(Matrix18& covariance, int at, double variance) {
  covariance.diagonal().segment<3>(at).array() += variance;
}

/// One step of the motion and of its errors.
void advance(MotionState& state, InertialState& inertial, const ImuStep& step) {
  const double t_s = step.duration_s;
  const Vector3d rate = step.angular_rate_rad_per_s - inertial.gyroscope_bias_rad_per_s;
  const Vector3d force = step.specific_force_mps2 - inertial.accelerometer_bias_mps2;
  const Matrix3d R = state.T_map_sensor.linear();
  const Vector3d gravity = R.transpose() * inertial.gravity_map_mps2;
  Vector3d& velocity = state.velocity.linear;

  Matrix18 A = Matrix18::Zero();
  A.block<3, 3>(kLinear, kLinear) = -cross_matrix(rate);
  A.block<3, 3>(kLinear, kAngular) = -cross_matrix(velocity);
  A.block<3, 3>(kLinear, kVelocity).setIdentity();
  A.block<3, 3>(kAngular, kAngular) = -cross_matrix(rate);
  A.block<3, 3>(kAngular, kGyroscope) = -Matrix3d::Identity();
  A.block<3, 3>(kVelocity, kAngular) = cross_matrix(gravity);
  A.block<3, 3>(kVelocity, kVelocity) = -cross_matrix(rate);
  A.block<3, 3>(kVelocity, kGyroscope) = -cross_matrix(velocity);
  A.block<3, 3>(kVelocity, kAccelerometer) = -Matrix3d::Identity();
  A.block<3, 3>(kVelocity, kGravity) = R.transpose();
  A *= t_s;
  const Matrix18 F = Matrix18::Identity() + A + 0.5 * A * A;
  inertial.covariance = F * inertial.covariance * F.transpose();
  add_variance(inertial.covariance, kAngular, t_s * kGyroscopeNoise * kGyroscopeNoise);
  add_variance(inertial.covariance, kVelocity, t_s * kAccelerometerNoise * kAccelerometerNoise);
  add_variance(inertial.covariance, kGyroscope, t_s * kGyroscopeWalk * kGyroscopeWalk);
  add_variance(inertial.covariance, kAccelerometer, t_s * kAccelerometerWalk * kAccelerometerWalk);

  const Matrix3d turn = rotation_of(t_s * rate);
  const Vector3d acceleration = force + gravity;
  state.T_map_sensor.translation() += t_s * (R * (velocity + 0.5 * t_s * acceleration));
  state.T_map_sensor.linear() = R * turn;
  velocity = turn.transpose() * (velocity + t_s * acceleration);
}

/// The covariance of the MotionState: the error of its angular velocity is minus that of the
/// gyroscope's bias.
Matrix12 covariance_of_motion(const Matrix18& covariance) {
  Matrix12 result = covariance.topLeftCorner<12, 12>();
  result.bottomRows<3>() *= -1.0;
  result.rightCols<3>() *= -1.0;
  return result;
}

}  // namespace

InertialState first_inertial_state(const MotionState& state, const Vector3d& specific_force_mps2) {
  InertialState result;
  result.gravity_map_mps2 =
      -kGravity_mps2 * (state.T_map_sensor.linear() * specific_force_mps2).normalized();
  result.covariance.topLeftCorner<9, 9>() = state.covariance.topLeftCorner<9, 9>();
  const auto variance = [](double sigma) { return sigma * sigma; };
  add_variance(result.covariance, kGyroscope, variance(kFirstGyroscopeBias_rad_per_s));
  add_variance(result.covariance, kAccelerometer, variance(kFirstAccelerometerBias_mps2));
  add_variance(result.covariance, kGravity, variance(kFirstGravity_mps2));
  return result;
}

InertialPrediction predicted(const MotionState& state, const InertialState& inertial,
                             const std::vector<ImuStep>& steps,
                             const Vector3d& mean_rate_rad_per_s) {
  InertialPrediction result{state, inertial};
  for (const ImuStep& step : steps) advance(result.state, result.inertial, step);
  result.state.T_map_sensor = orthonormalized(result.state.T_map_sensor);
  result.state.velocity.angular = mean_rate_rad_per_s;
  Matrix18& covariance = result.inertial.covariance;
  covariance = (0.5 * (covariance + covariance.transpose())).eval();
  result.state.covariance = covariance_of_motion(covariance);
  return result;
}

namespace {

/// P + N: the covariance of the prediction's pose and of a registration's errors beyond its own.
Matrix6 covariance_of_pose(const InertialPrediction& prediction) {
  Matrix6 result = prediction.inertial.covariance.topLeftCorner<6, 6>();
  result.diagonal() += six(kRegistration_m, kRegistration_rad).cwiseAbs2();
  return result;
}

/// L z
Vector6 weighted_innovation(const InertialPrediction& prediction, const MotionState& found) {
  const Vector6 moved =
      vector_of(logarithm(prediction.state.T_map_sensor.inverse() * found.T_map_sensor));
  return found.covariance.topLeftCorner<6, 6>().ldlt().solve(moved);
}

}  // namespace

double normalized_innovation(const InertialPrediction& prediction, const MotionState& found,
                             const Matrix6& of_scan) {
  const Vector6 weighted = weighted_innovation(prediction, found);
  const Matrix6 covariance = of_scan + of_scan * covariance_of_pose(prediction) * of_scan;
  const Eigen::SelfAdjointEigenSolver<Matrix6> modes(covariance);
  const double least = 1e-9 * modes.eigenvalues().maxCoeff();
  double sum = 0.0;
  for (int i = 0; i < 6; ++i) {
    const double along = modes.eigenvectors().col(i).dot(weighted);
    if (modes.eigenvalues()[i] > least) sum += along * along / modes.eigenvalues()[i];
  }
  return sum;
}

InertialState corrected(const InertialPrediction& prediction, const MotionState& found,
                        const Matrix6& of_scan, const Matrix6& known) {
  const Matrix18& before = prediction.inertial.covariance;
  const Eigen::Matrix<double, 18, 6> with_pose = before.leftCols<6>();
  const auto inverse_share = [&](const Matrix6& information) {
    return Eigen::PartialPivLU<Matrix6>(Matrix6::Identity() +
                                        information * covariance_of_pose(prediction));
  };
  const Eigen::Matrix<double, 18, 1> change =
      with_pose * inverse_share(of_scan).solve(weighted_innovation(prediction, found));
  InertialState result = prediction.inertial;
  result.gyroscope_bias_rad_per_s += change.segment<3>(kGyroscope);
  result.accelerometer_bias_mps2 += change.segment<3>(kAccelerometer);
  result.gravity_map_mps2 += change.segment<3>(kGravity);
  result.gravity_map_mps2 *= kGravity_mps2 / result.gravity_map_mps2.norm();
  result.covariance =
      before - with_pose * inverse_share(known).solve(known) * with_pose.transpose();
  result.covariance = (0.5 * (result.covariance + result.covariance.transpose())).eval();
  return result;
}

void turn(InertialState& inertial, const Matrix3d& R_corrected_map) {
  inertial.gravity_map_mps2 = R_corrected_map * inertial.gravity_map_mps2;
  Matrix18 turn = Matrix18::Identity();
  turn.block<3, 3>(kGravity, kGravity) = R_corrected_map;
  inertial.covariance = (turn * inertial.covariance * turn.transpose()).eval();
}

void set_gyroscope_bias(InertialState& inertial, const Vector3d& bias_rad_per_s,
                        double duration_s) {
  inertial.gyroscope_bias_rad_per_s = bias_rad_per_s;
  inertial.covariance.middleRows<3>(kGyroscope).setZero();
  inertial.covariance.middleCols<3>(kGyroscope).setZero();
  const double sigma_rad_per_s = std::sqrt(2.0) * kRegistration_rad / duration_s;
  add_variance(inertial.covariance, kGyroscope, sigma_rad_per_s * sigma_rad_per_s);
}

InertialState kept(const InertialState& inertial, const MotionState& found) {
  InertialState result = inertial;
  result.covariance.topRightCorner<9, 9>().setZero();
  result.covariance.bottomLeftCorner<9, 9>().setZero();
  result.covariance.topLeftCorner<9, 9>() = found.covariance.topLeftCorner<9, 9>();
  return result;
}

}  // namespace hqslam::slam
