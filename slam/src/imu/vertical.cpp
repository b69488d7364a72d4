#include "imu/vertical.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>

#include "alignment/cross_matrix.h"
#include "hqslam/core/imu_sample.h"

namespace hqslam::slam {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

using Table = Eigen::Matrix<double, Eigen::Dynamic, 3>;  // a row for each pose

constexpr std::size_t kFewestPoses = 6;
constexpr double kWholeSpan = 0.8;
/// Poses and forces that fit each other: the sensor was not pushed between two samples, no pose is
/// another place's.
constexpr double kMostResidual_m = 0.1;
constexpr double kMostOfGravity_mps2 = 0.7;
// Where each lies in the state.
constexpr int kGravity = 0;
constexpr int kBias = 3;
constexpr int kLean = 6;
constexpr int kLeanOfScan = 9;

/// Of the lean, what one scan is turned by.
constexpr double kShare = 0.2;
// Standard deviations at first, and of what comes from scan to scan.
constexpr double kFirstGravity_mps2 = 1.0;
constexpr double kFirstBias_mps2 = 0.2;
constexpr double kFirstLeanOfScan_rad = 2e-4;
constexpr double kBiasWalk_mps2 = 2e-4;
constexpr double kLeanWalk_rad = 2e-4;
constexpr double kLeanOfScanWalk_rad = 2e-6;
/// Of a scan's z: 0.03, and five times that because thirty scans see the same three seconds.
constexpr double kNoise_mps2 = 0.15;

/// R_last_step of the middle of each step, by the gyroscope.
std::vector<Matrix3d> turned_back(const std::vector<ImuStep>& steps) {
  std::vector<Matrix3d> R_last_step(steps.size());
  Matrix3d R_last = Matrix3d::Identity();  // of the end of each step
  for (std::size_t i = steps.size(); i-- > 0;) {
    const Vector3d half_turn_rad = 0.5 * steps[i].duration_s * steps[i].angular_rate_rad_per_s;
    const Matrix3d half = exponential(Twist{Vector3d::Zero(), -half_turn_rad}).linear();
    R_last_step[i] = R_last * half;
    R_last = R_last_step[i] * half;
  }
  return R_last_step;
}

/// The double integral of a force since the first pose, at each pose. force(i): during a step, in
/// the last pose's frame.
template <typename Force>
Table integrated_twice(const Trajectory& poses, const std::vector<ImuStep>& steps,
                       const Force& force) {
  Table moved(poses.size(), 3);
  Vector3d position = Vector3d::Zero();
  Vector3d velocity = Vector3d::Zero();
  double time_s = poses.front().stamp_s;
  std::size_t next = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Vector3d acceleration = force(i);
    const double end_s = time_s + steps[i].duration_s;
    for (; next < poses.size() && (poses[next].stamp_s < end_s || i + 1 == steps.size()); ++next) {
      const double t_s = poses[next].stamp_s - time_s;
      moved.row(next) = position + t_s * velocity + 0.5 * t_s * t_s * acceleration;
    }
    const double t_s = steps[i].duration_s;
    position += t_s * velocity + 0.5 * t_s * t_s * acceleration;
    velocity += t_s * acceleration;
    time_s = end_s;
  }
  return moved;
}

}  // namespace

std::optional<FeltGravity> felt_gravity(const Trajectory& poses,
                                        const std::vector<ImuStep>& steps) {
  if (poses.size() < kFewestPoses || steps.empty()) return std::nullopt;
  const std::vector<Matrix3d> R_last_step = turned_back(steps);
  Table coasted = -integrated_twice(poses, steps, [&](std::size_t i) -> Vector3d {
    return R_last_step[i] * steps[i].specific_force_mps2;
  });
  Table terms(poses.size(), 3);
  const Pose T_last_map = poses.back().T_map_sensor.inverse();
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const double t_s = poses[k].stamp_s - poses.front().stamp_s;
    terms.row(k) << 1.0, t_s, 0.5 * t_s * t_s;
    coasted.row(k) += T_last_map * poses[k].T_map_sensor.translation();
  }
  const Eigen::ColPivHouseholderQR<Table> solver(terms);
  const Matrix3d solved = solver.solve(coasted);
  FeltGravity felt{solved.row(2), Matrix3d::Zero()};
  const double residual_m = (terms * solved - coasted).rowwise().norm().maxCoeff();
  if (residual_m > kMostResidual_m ||
      std::abs(felt.gravity_mps2.norm() - kGravity_mps2) > kMostOfGravity_mps2) {
    return std::nullopt;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const Matrix3d of_unit = solver.solve(integrated_twice(
        poses, steps, [&](std::size_t i) -> Vector3d { return R_last_step[i].col(axis); }));
    felt.of_bias.col(axis) = of_unit.row(2);
  }
  return felt;
}

std::optional<double> Vertical::begin_s() const {
  return registered_.empty() ? std::nullopt : std::optional(registered_.front().stamp_s);
}

void Vertical::turn(const Matrix3d& R_corrected_map) {
  for (StampedPose& pose : registered_) {
    pose.T_map_sensor = Pose(R_corrected_map) * pose.T_map_sensor;
  }
  if (!state_) return;
  Matrix12 turn = Matrix12::Identity();
  turn.block<3, 3>(kGravity, kGravity) = R_corrected_map;
  turn.block<3, 3>(kLean, kLean) = R_corrected_map;
  *state_ = turn * *state_;
  covariance_ = (turn * covariance_ * turn.transpose()).eval();
}

void Vertical::begin(const Vector3d& gravity_map_mps2) {
  state_ = State::Zero();
  state_->segment<3>(kGravity) = gravity_map_mps2;
  add_variance(kGravity, kFirstGravity_mps2);
  add_variance(kBias, kFirstBias_mps2);
  add_variance(kLeanOfScan, kFirstLeanOfScan_rad);
}

void Vertical::add_variance(int at, double sigma) {
  covariance_.diagonal().segment<3>(at).array() += sigma * sigma;
}

void Vertical::add_scan(const Matrix3d& R_map_sensor) {
  Matrix12 F = Matrix12::Identity();
  F.block<3, 3>(kLean, kLeanOfScan) = R_map_sensor;
  *state_ = F * *state_;
  covariance_ = (F * covariance_ * F.transpose()).eval();
  add_variance(kBias, kBiasWalk_mps2);
  add_variance(kLean, kLeanWalk_rad);
  add_variance(kLeanOfScan, kLeanOfScanWalk_rad);
}

void Vertical::measure(const Matrix3d& R_map_sensor, const FeltGravity& felt) {
  const Vector3d gravity = state_->segment<3>(kGravity);
  const Vector3d lean = state_->segment<3>(kLean);
  const Matrix3d R_sensor_map = R_map_sensor.transpose();
  Eigen::Matrix<double, 3, 12> H = Eigen::Matrix<double, 3, 12>::Zero();
  H.block<3, 3>(0, kGravity) = R_sensor_map * (Matrix3d::Identity() + cross_matrix(lean));
  H.block<3, 3>(0, kBias) = -felt.of_bias;
  H.block<3, 3>(0, kLean) = -R_sensor_map * cross_matrix(gravity);
  const Vector3d expected =
      R_sensor_map * (gravity + lean.cross(gravity)) - felt.of_bias * state_->segment<3>(kBias);
  Matrix3d S = H * covariance_ * H.transpose();
  S.diagonal().array() += kNoise_mps2 * kNoise_mps2;
  const Eigen::Matrix<double, 12, 3> K = S.ldlt().solve(H * covariance_).transpose();
  *state_ += K * (felt.gravity_mps2 - expected);
  covariance_ = (covariance_ - K * S * K.transpose()).eval();
}

Vector3d Vertical::take_turn_rad(const Matrix3d& R_map_sensor) {
  Vector3d turn_rad =
      -kShare * state_->segment<3>(kLean) - R_map_sensor * state_->segment<3>(kLeanOfScan);
  const Vector3d down = state_->segment<3>(kGravity).normalized();
  turn_rad -= down * down.dot(turn_rad);
  state_->segment<3>(kLean) += turn_rad;
  return turn_rad;
}

Pose Vertical::upright(const StampedPose& found, const Vector3d& gravity_map_mps2,
                       const std::vector<ImuStep>& steps) {
  registered_.push_back(found);
  Pose& T_map_sensor = registered_.back().T_map_sensor;
  const bool is_whole = found.stamp_s - registered_.front().stamp_s > kWholeSpan * kSpan_s;
  if (is_whole && !state_) begin(gravity_map_mps2);
  if (state_) {
    const Matrix3d R_map_sensor = T_map_sensor.linear();
    add_scan(R_map_sensor);
    const auto felt = is_whole ? felt_gravity(registered_, steps) : std::nullopt;
    if (felt) measure(R_map_sensor, *felt);
    const Twist turn{Vector3d::Zero(), take_turn_rad(R_map_sensor)};
    T_map_sensor.linear() = exponential(turn).linear() * R_map_sensor;
  }
  const Pose upright = T_map_sensor;
  registered_.erase(registered_.begin(),
                    std::find_if(registered_.begin(), registered_.end(), [&](const auto& pose) {
                      return pose.stamp_s >= found.stamp_s - kSpan_s;
                    }));
  return upright;
}

}  // namespace hqslam::slam
