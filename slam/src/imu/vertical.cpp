#include "imu/vertical.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>

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
// Where the errors of each lie.
constexpr int kGravity = 0;
constexpr int kBias = 3;
constexpr int kLean = 6;
constexpr int kLeanOfScan = 9;

static double env(const char* n, double v) { return getenv(n) ? atof(getenv(n)) : v; }
const double kShare = env("KP", 0.2);  ///< of the lean, that one scan is turned by
/// Standard deviations at first, and from scan to scan.
constexpr double kFirstGravity_mps2 = 1.0;
constexpr double kFirstBias_mps2 = 0.2;
const double kFirstLeanOfScan_rad = env("KI", 2e-4);
constexpr double kBiasWalk_mps2 = 2e-4;
const double kLeanWalk_rad = env("KW", 2e-4);
const double kLeanOfScanWalk_rad = env("KR", 2e-6);
/// Of one scan's z: neighbours see the same three seconds.
const double kNoise_mps2 = env("KN", 0.03);

Matrix3d cross_of(const Vector3d& v) {
  Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

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

/// z and L.
struct FeltGravity {
  Vector3d gravity_mps2;
  Matrix3d of_bias;
};

/// Nothing where poses and specific forces do not fit each other.
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

}  // namespace

std::optional<double> Vertical::begin_s() const {
  return registered_.empty() ? std::nullopt : std::optional(registered_.front().stamp_s);
}

void Vertical::turn(const Matrix3d& R_corrected_map) {
  for (StampedPose& pose : registered_) {
    pose.T_map_sensor = Pose(R_corrected_map) * pose.T_map_sensor;
  }
  if (!state_) return;
  Eigen::Matrix<double, 12, 12> turn = Eigen::Matrix<double, 12, 12>::Identity();
  turn.block<3, 3>(kGravity, kGravity) = R_corrected_map;
  turn.block<3, 3>(kLean, kLean) = R_corrected_map;
  *state_ = turn * *state_;
  covariance_ = (turn * covariance_ * turn.transpose()).eval();
}

void Vertical::begin(const Vector3d& gravity_map_mps2) {
  state_ = State::Zero();
  state_->segment<3>(kGravity) = gravity_map_mps2;
  const auto set = [&](int at, double sigma) {
    covariance_.diagonal().segment<3>(at).setConstant(sigma * sigma);
  };
  set(kGravity, kFirstGravity_mps2);
  set(kBias, kFirstBias_mps2);
  set(kLeanOfScan, kFirstLeanOfScan_rad);
}

Pose Vertical::upright(const StampedPose& found, const Vector3d& gravity_map_mps2,
                       const std::vector<ImuStep>& steps) {
  registered_.push_back(found);
  Pose& T_map_sensor = registered_.back().T_map_sensor;
  const bool is_whole = found.stamp_s - registered_.front().stamp_s > kWholeSpan * kSpan_s;
  if (is_whole && !state_) begin(gravity_map_mps2);
  if (state_) {
    // One scan more leans.
    const Matrix3d R = T_map_sensor.linear();
    Eigen::Matrix<double, 12, 12> F = Eigen::Matrix<double, 12, 12>::Identity();
    F.block<3, 3>(kLean, kLeanOfScan) = R;
    *state_ = F * *state_;
    covariance_ = (F * covariance_ * F.transpose()).eval();
    covariance_.diagonal().segment<3>(kBias).array() += kBiasWalk_mps2 * kBiasWalk_mps2;
    covariance_.diagonal().segment<3>(kLean).array() += kLeanWalk_rad * kLeanWalk_rad;
    covariance_.diagonal().segment<3>(kLeanOfScan).array() += kLeanOfScanWalk_rad * kLeanOfScanWalk_rad;
    if (const auto felt = is_whole ? felt_gravity(registered_, steps) : std::nullopt) {
      // R = exp(lean) R_true, so R_true^T g = R^T exp(lean) g = R^T (g + lean x g).
      const Vector3d g = state_->segment<3>(kGravity);
      const Vector3d lean = state_->segment<3>(kLean);
      Eigen::Matrix<double, 3, 12> H = Eigen::Matrix<double, 3, 12>::Zero();
      H.block<3, 3>(0, kGravity) = R.transpose() * (Matrix3d::Identity() + cross_of(lean));
      H.block<3, 3>(0, kBias) = -felt->of_bias;
      H.block<3, 3>(0, kLean) = -R.transpose() * cross_of(g);
      const Vector3d expected = R.transpose() * (g + lean.cross(g)) - felt->of_bias * state_->segment<3>(kBias);
      Matrix3d S = H * covariance_ * H.transpose();
      S.diagonal().array() += kNoise_mps2 * kNoise_mps2;
      const Eigen::Matrix<double, 12, 3> K = S.ldlt().solve(H * covariance_).transpose();
      *state_ += K * (felt->gravity_mps2 - expected);
      covariance_ = (covariance_ - K * S * K.transpose()).eval();
    }
    // Never about the vertical.
    const Vector3d down = state_->segment<3>(kGravity).normalized();
    Vector3d turn_rad = kShare * state_->segment<3>(kLean) + R * state_->segment<3>(kLeanOfScan);
    turn_rad -= down * down.dot(turn_rad);
    const Pose turned = exponential(Twist{Vector3d::Zero(), -turn_rad});
    T_map_sensor.linear() = turned.linear() * R;
    state_->segment<3>(kLean) -= turn_rad;
  }
  const Pose result = T_map_sensor;
  const auto recent = std::find_if(registered_.begin(), registered_.end(), [&](const auto& pose) {
    return pose.stamp_s >= found.stamp_s - kSpan_s;
  });
  registered_.erase(registered_.begin(), recent);
  return result;
}

}  // namespace hqslam::slam
