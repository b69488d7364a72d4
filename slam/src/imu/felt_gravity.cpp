#include "imu/felt_gravity.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

#include "alignment/motion_state.h"
#include "hqslam/core/imu_sample.h"

namespace hqslam::slam {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

using Table = Eigen::Matrix<double, Eigen::Dynamic, 3>;  // a row for each pose

constexpr double kSpan_s = 3.0;  // chosen on simulated drives alone
constexpr double kWholeSpan = 0.8;
constexpr std::size_t kFewestPoses = 6;
constexpr std::size_t kMostEnded = 100;
/// Largest residuals: a sensor pushed between two samples or a wrong pose has larger ones.
constexpr double kMostResidual_m = 0.05;
constexpr double kMostOfGravity_mps2 = 0.7;
/// Standard deviation of z with small residuals, and its growth with them (per s^2). With a third
/// of both simulated drives gain nothing.
constexpr double kSigma_mps2 = 0.01;
constexpr double kSigmaPerResidual = 3.0;

/// Errors applied to the data of a window before gravity is computed: bias, then ImuErrors.
using Errors = Eigen::Matrix<double, 11, 1>;
/// Their increments for the finite differences.
const Errors kTried =
    (Errors() << 0.01, 0.01, 0.01, 1e-3, 1e-3, 1e-3, 1e-3, 0.01, 0.01, 0.01, 1e-3).finished();

struct Felt {
  Vector3d gravity_mps2;
  double residual_m = 0.0;  ///< root mean square
};

/// The gravity of felt_gravity() for an inertial sensor with these errors.
Felt felt(const Trajectory& poses, const std::vector<ImuStep>& steps, const Errors& errors) {
  const Vector3d bias_mps2 = errors.head<3>();
  const Matrix3d R_lidar_imu = rotation_of(-errors.segment<3>(3));
  const double length = 1.0 + errors[6];
  const Vector3d lever_m = errors.segment<3>(7);
  const double late_s = errors[10];

  // R_last_step of the middle of each step, by the gyroscope.
  std::vector<Matrix3d> R_last_step(steps.size());
  Matrix3d R_last = rotation_of(
      -late_s * (R_lidar_imu * steps.back().angular_rate_rad_per_s));  // of the end of each step
  for (std::size_t i = steps.size(); i-- > 0;) {
    const Matrix3d half =
        rotation_of(-0.5 * steps[i].duration_s * (R_lidar_imu * steps[i].angular_rate_rad_per_s));
    R_last_step[i] = R_last * half;
    R_last = R_last_step[i] * half;
  }
  // The positions minus the double integral of the forces, at each pose.
  Table coasted(poses.size(), 3);
  Table terms(poses.size(), 3);
  const Pose T_last_map = poses.back().T_map_sensor.inverse();
  Vector3d position = Vector3d::Zero();
  Vector3d velocity = Vector3d::Zero();
  double time_s = poses.front().stamp_s;
  std::size_t next = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Vector3d force =
        R_last_step[i] * (R_lidar_imu * (steps[i].specific_force_mps2 - bias_mps2) / length);
    const double end_s = time_s + steps[i].duration_s;
    const bool is_last = i + 1 == steps.size();
    for (; next < poses.size() && (poses[next].stamp_s + late_s < end_s || is_last); ++next) {
      const double t_s = poses[next].stamp_s + late_s - time_s;
      const double since_s = poses[next].stamp_s - poses.front().stamp_s;
      const Vector3d integral = position + t_s * velocity + 0.5 * t_s * t_s * force;
      terms.row(next) << 1.0, since_s, 0.5 * since_s * since_s;
      coasted.row(next) = T_last_map * (poses[next].T_map_sensor * lever_m) - integral;
    }
    const double t_s = steps[i].duration_s;
    position += t_s * velocity + 0.5 * t_s * t_s * force;
    velocity += t_s * force;
    time_s = end_s;
  }
  const Matrix3d solved = terms.colPivHouseholderQr().solve(coasted);
  return {solved.row(2), std::sqrt((terms * solved - coasted).rowwise().squaredNorm().mean())};
}

}  // namespace

std::optional<FeltGravity> felt_gravity(const Trajectory& poses,
                                        const std::vector<ImuStep>& steps) {
  if (poses.size() < kFewestPoses || steps.empty()) return std::nullopt;
  const auto [gravity_mps2, residual_m] = felt(poses, steps, Errors::Zero());
  if (residual_m > kMostResidual_m ||
      std::abs(gravity_mps2.norm() - kGravity_mps2) > kMostOfGravity_mps2) {
    return std::nullopt;
  }
  Eigen::Matrix<double, 3, 11> by_error;
  for (int i = 0; i < by_error.cols(); ++i) {
    const Errors tried = kTried[i] * Errors::Unit(i);
    by_error.col(i) =
        (felt(poses, steps, tried).gravity_mps2 - felt(poses, steps, -tried).gravity_mps2) /
        (2.0 * kTried[i]);
  }
  return FeltGravity{poses.back().stamp_s,
                     std::hypot(kSigma_mps2, kSigmaPerResidual * residual_m),
                     gravity_mps2,
                     by_error.leftCols<3>(),
                     by_error.rightCols<8>(),
                     0};
}

void GravityWindow::add(const StampedPose& registered, const Vector3d& gyroscope_bias_rad_per_s) {
  gyroscope_bias_rad_per_s_ = gyroscope_bias_rad_per_s;
  poses_.push_back(registered);
  const auto is_old = [&](const StampedPose& pose) {
    return registered.stamp_s - pose.stamp_s > kSpan_s;
  };
  poses_.erase(poses_.begin(), std::find_if_not(poses_.begin(), poses_.end(), is_old));
}

void GravityWindow::correct(const Pose& T_corrected_map) {
  for (StampedPose& pose : poses_) pose.T_map_sensor = T_corrected_map * pose.T_map_sensor;
}

void GravityWindow::end(std::size_t scan, const ImuBuffer& imu, const Matrix3d& R_level_sensor) {
  if (poses_.empty()) return;
  const double begin_s = poses_.front().stamp_s;
  const double end_s = poses_.back().stamp_s;
  if (end_s - begin_s < kWholeSpan * kSpan_s) return;
  std::vector<ImuStep> steps = imu.steps(begin_s, end_s, R_level_sensor);
  const StampedPose last = poses_.back();
  ended_.push_back({scan, std::exchange(poses_, {last}), std::move(steps)});
  if (ended_.size() > kMostEnded) ended_.pop_front();
}

std::vector<FeltGravity> GravityWindow::take() {
  std::vector<FeltGravity> result;
  for (Ended& window : std::exchange(ended_, {})) {
    for (ImuStep& step : window.steps) step.angular_rate_rad_per_s -= gyroscope_bias_rad_per_s_;
    std::optional<FeltGravity> felt = felt_gravity(window.poses, window.steps);
    if (!felt) continue;
    felt->scan = window.scan;
    result.push_back(*felt);
  }
  return result;
}

}  // namespace hqslam::slam
