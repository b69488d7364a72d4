#include "alignment/motion_state.h"

#include <algorithm>
#include <cmath>

#include "alignment/rotation_derivatives.h"

namespace hqslam::slam {

namespace {

constexpr double kFading_s = 1.0;
/// Weight of a new step in the density of accelerations.
constexpr double kNewShare = 0.05;

}  // namespace

Vector6 six(double linear, double angular) {
  Vector6 result;
  result << linear, linear, linear, angular, angular, angular;
  return result;
}

Vector6 vector_of(const Twist& twist) {
  Vector6 result;
  result << twist.linear, twist.angular;
  return result;
}

Twist twist_of(const Vector6& vector) { return {vector.head<3>(), vector.tail<3>()}; }

Eigen::Matrix3d rotation_of(const Eigen::Vector3d& turn_rad) {
  return exponential({Eigen::Vector3d::Zero(), turn_rad}).linear();
}

Matrix6 adjoint(const Pose& pose) {
  Matrix6 result = Matrix6::Zero();
  result.topLeftCorner<3, 3>() = pose.linear();
  result.bottomRightCorner<3, 3>() = pose.linear();
  result.topRightCorner<3, 3>() = cross_matrix(pose.translation()) * pose.linear();
  return result;
}

MotionState unknown_motion(const Pose& T_map_sensor) {
  MotionState result;
  result.T_map_sensor = T_map_sensor;
  Vector12 sigma;
  sigma << six(1e-3, 1e-4), six(20.0, 1.0);
  result.covariance = sigma.cwiseAbs2().asDiagonal();
  return result;
}

AccelerationNoise::AccelerationNoise() : density_(six(10.0, 1.0)) {}

void AccelerationNoise::learn(const Twist& before, const Twist& after, double step_s) {
  const Vector6 change = vector_of(after) - vector_of(before);
  const Vector6 least = six(0.1, 0.002);
  density_ =
      ((1.0 - kNewShare) * density_ + kNewShare / step_s * change.cwiseAbs2()).cwiseMax(least);
}

MotionState predicted(const MotionState& state, double duration_s, double steady_s,
                      const Vector6& density, bool is_velocity_measured) {
  const double beyond_s = std::max(0.0, duration_s - steady_s);
  const double kept = std::exp(-beyond_s / kFading_s);
  const double t_s = duration_s - beyond_s + kFading_s * (1.0 - kept);
  const Pose motion = exponential(t_s * state.velocity);
  Matrix12 F = Matrix12::Identity();
  F.topLeftCorner<6, 6>() = adjoint(motion.inverse());
  F.topRightCorner<6, 6>().diagonal().setConstant(duration_s);
  MotionState result;
  if (is_velocity_measured) result.measured_step_s = duration_s;
  result.T_map_sensor = state.T_map_sensor * motion;
  result.velocity = kept * state.velocity;
  result.covariance = F * state.covariance * F.transpose();
  // The decayed part of the velocity is unknown.
  const Vector6 forgotten = (1.0 - kept) * vector_of(state.velocity);
  const Vector6 lost_m = (duration_s - t_s) * vector_of(state.velocity);
  const double of_position = is_velocity_measured ? 1.0 / 3.0 : 1.0;
  const double of_both = is_velocity_measured ? 0.5 : 1.0;
  result.covariance.topLeftCorner<6, 6>().diagonal() +=
      of_position * std::pow(duration_s, 3) * density + lost_m.cwiseAbs2();
  result.covariance.bottomRightCorner<6, 6>().diagonal() +=
      duration_s * density + forgotten.cwiseAbs2();
  const Vector6 coupling =
      of_both * duration_s * duration_s * density + lost_m.cwiseProduct(forgotten);
  result.covariance.topRightCorner<6, 6>().diagonal() += coupling;
  result.covariance.bottomLeftCorner<6, 6>().diagonal() += coupling;
  return result;
}

MotionState with_innovation(const MotionState& expected, const Twist& innovation,
                            double duration_s) {
  const Vector6 variance = vector_of(innovation).cwiseAbs2();
  MotionState result = expected;
  result.covariance.topLeftCorner<6, 6>().diagonal() += variance;
  result.covariance.topRightCorner<6, 6>().diagonal() += variance / duration_s;
  result.covariance.bottomLeftCorner<6, 6>().diagonal() += variance / duration_s;
  result.covariance.bottomRightCorner<6, 6>().diagonal() += variance / (duration_s * duration_s);
  return result;
}

}  // namespace hqslam::slam
