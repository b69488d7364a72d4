#include "alignment/drift.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace hqslam::slam {

namespace {

/// Factors of variances. These, those that follow, shares and start: fitted to simulated drives
/// alone (drift.h).
constexpr double kAlongGround = 23.0;
constexpr double kHeight = 1.35;
constexpr double kRollAndPitch = 5.9;
constexpr double kHeading = 11.3;
/// Growth of those of x, y and yaw with the standard deviation of x and y: exponent, the value at
/// which they are as above, and the largest, which only unregistered scans exceed.
constexpr double kPower = 0.6;
constexpr double kUsual_m = 0.005;
constexpr double kMost_m = 0.05;
/// Shares of the mean squares of unforeseen motion along and about the axes; weight of a new scan
/// in those.
constexpr double kShakeAlong = 0.3;
constexpr double kShakeAbout = 0.0097;
constexpr double kNewJoltShare = 0.05;
/// The share of a turn that is taken for uneven before a second velocity shows how even turns are.
constexpr double kUnevenShare = 0.5;
/// Standard deviation of a scan's unforeseen turn about one axis, and scans before it is known.
/// Simulated vehicles have at most 0.005 rad, robots in rooms 0.012 to 0.026, hands 0.035 to 0.07;
/// a VLP-16 on a car 0.002.
constexpr double kUneven_rad = 0.01;
constexpr int kFewJolts = 5;  // with fewer a climb of simulated stairs fails
/// One such turn: above those that 16 rows of a raw HDL-64E on a car pretend
/// (weights/NOTEBOOK.md, "Acceleration within a scan").
constexpr double kUnevenOnce_rad = 0.015;
constexpr double kShare_per_m = 0.0135;
/// Roll and pitch due to beam errors; the rest of it after levelling, and then their effect on x
/// and y, which is negligible beside an unlevelled lean.
constexpr double kLean_rad2_per_m = 5e-4 * 5e-4;
constexpr double kLevelledLean_rad2_per_m = 1.2e-4 * 1.2e-4;
constexpr double kLevelledSideways_m2_per_m = 3.2e-3 * 3.2e-3;
/// Roll and pitch where nothing holds them, and the path after which that begins: simulated streets
/// and hills of which only the upper rows are left rise by 1 to 40 m in a hundred.
constexpr double kUnheldLean_rad2_per_m = 1.4e-2 * 1.4e-2;
constexpr double kUnheld_m = 5.0;
/// Tilt at the start as a share of the spacing of the rows; length of the start.
constexpr double kStartTilt = 0.019;
constexpr double kStart_m = 2.6;
/// Share of the mean square of unforeseen turns that remains of the start, about the axes, and with
/// kStartLever_m along them. Chosen with kUnevenShare on simulated hands that turn
/// (weights/NOTEBOOK.md, "Starts in a hand that turns").
constexpr double kStartTurn = 0.006;
constexpr double kStartLever_m = 10.0;
/// Row spacing assumed for a sensor with one row.
constexpr double kSpacing_rad = 0.0368;

/// Mean spacing of the measured rows.
double row_spacing_rad(const SensorModel& sensor) {
  const SensorModel measured =
      sensor.measured_rows ? select_rows(sensor, *sensor.measured_rows) : sensor;
  if (measured.rows() < 2) return kSpacing_rad;
  const auto [low, high] = std::ranges::minmax_element(measured.beam_elevation_rad);
  return (*high - *low) / (measured.rows() - 1);
}

}  // namespace

Matrix6 unknown_covariance() {
  return Vector6::Constant(std::numeric_limits<double>::infinity()).asDiagonal();
}

Matrix6 carried(const Matrix6& covariance, const Pose& motion) {
  const Matrix6 turn = adjoint(motion.inverse());
  return turn * covariance * turn.transpose();
}

Matrix6 growth(const Matrix6& before, const Matrix6& expected, const Pose& motion) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(expected - carried(before, motion));
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).asDiagonal() *
         solver.eigenvectors().transpose();
}

DriftState carried(const DriftState& state, const Pose& motion) {
  return {carried(state.drift, motion), carried(state.unmeasured, motion), state.is_anywhere};
}

Drift::Drift(const SensorModel& sensor)
    : start_variance_(std::pow(kStartTilt * row_spacing_rad(sensor), 2)),
      scan_period_s_(sensor.scan_period_s) {}

void Drift::learn(const Twist& velocity) {
  if (velocity_) {
    const Vector6 unforeseen = scan_period_s_ * (vector_of(velocity) - vector_of(*velocity_));
    ++jolt_count_;
    last_jolt_ = unforeseen.cwiseAbs2();
    jolts_ += std::max(kNewJoltShare, 1.0 / jolt_count_) * (last_jolt_ - jolts_);
  }
  velocity_ = velocity;
}

Matrix6 Drift::against_map(const MotionState& state) const {
  const Matrix6 covariance = state.covariance.topLeftCorner<6, 6>();
  const double variance_m2 =
      std::min(0.5 * (covariance(0, 0) + covariance(1, 1)), kMost_m * kMost_m);
  const double growth = std::pow(variance_m2 / (kUsual_m * kUsual_m), kPower);
  Vector6 variance;
  variance << kAlongGround * growth, kAlongGround * growth, kHeight, kRollAndPitch, kRollAndPitch,
      kHeading * growth;
  const Vector6 factor = variance.cwiseSqrt();
  Matrix6 result = factor.asDiagonal() * covariance * factor.asDiagonal();
  result.diagonal() += shake(state.velocity);
  return result;
}

Vector6 Drift::jolts(const Twist& velocity) const {
  if (jolt_count_ > 0) return jolts_;
  Vector6 assumed = Vector6::Zero();
  assumed.tail<3>() = (kUnevenShare * scan_period_s_ * velocity.angular).cwiseAbs2();
  return assumed;
}

bool Drift::is_uneven() const {
  return (jolt_count_ >= kFewJolts && jolts_.tail<3>().maxCoeff() > kUneven_rad * kUneven_rad) ||
         last_jolt_.tail<3>().maxCoeff() > kUnevenOnce_rad * kUnevenOnce_rad;
}

Vector6 Drift::shake(const Twist& velocity) const {
  return six(kShakeAlong, kShakeAbout).cwiseProduct(jolts(velocity));
}

void Drift::move(const Pose& motion) {
  state_ = carried(state_, motion);
  if (uncertain_keyframe_) uncertain_keyframe_ = carried(*uncertain_keyframe_, motion);
}

bool Drift::inherit_uncertainty(const Matrix6& against_map, bool is_known) {
  if (!uncertain_keyframe_) return false;
  const Matrix6 feigned = growth(against_map, *uncertain_keyframe_, Pose::Identity());
  state_.unmeasured += feigned;
  *uncertain_keyframe_ -= feigned;
  if (is_known) uncertain_keyframe_.reset();
  return true;
}

void Drift::grow(const Pose& motion, const MotionState& state, Level level) {
  move(motion);
  const bool is_levelled = level == Level::kByGravity;
  const double step_m = motion.translation().norm();
  unheld_path_m_ = level == Level::kByNothing ? unheld_path_m_ + step_m : 0.0;
  const double unheld = 1.0 - std::exp(-unheld_path_m_ / kUnheld_m);
  const double start_step_m = step_m + kStart_m * rotation_angle_rad(motion);
  const double begun =
      std::exp(-start_path_m_ / kStart_m) - std::exp(-(start_path_m_ + start_step_m) / kStart_m);
  const double turn_rad2 = kStartTurn * jolts(state.velocity).tail<3>().sum();
  state_.drift += kShare_per_m * step_m * against_map(state);
  state_.drift.diagonal() +=
      begun * (shake(state.velocity) + six(kStartLever_m * kStartLever_m * turn_rad2, turn_rad2));
  state_.drift.diagonal().segment<2>(3).array() +=
      begun * start_variance_ + step_m * (is_levelled
                                              ? kLevelledLean_rad2_per_m
                                              : kLean_rad2_per_m + unheld * kUnheldLean_rad2_per_m);
  if (is_levelled) {
    state_.drift.diagonal().head<2>().array() += step_m * kLevelledSideways_m2_per_m;
  }
  start_path_m_ += start_step_m;
}

void Drift::lose(const Matrix6& against_map, bool is_carried) {
  state_.unmeasured += against_map;
  state_.is_anywhere = state_.is_anywhere || is_carried;
  velocity_.reset();
  uncertain_keyframe_.reset();
}

DriftState improved(const DriftState& later, const DriftImprovement& earlier, const Pose& motion,
                    bool is_path_known) {
  const auto& [before, after] = earlier;
  return {later.drift + carried(after.drift - before.drift, motion),
          later.unmeasured + carried(after.unmeasured - before.unmeasured, motion),
          later.is_anywhere && !(is_path_known && !after.is_anywhere)};
}

Matrix6 Drift::own_covariance(const Pose& motion, const Matrix6& against_map) const {
  return carried(state_.drift, motion) + against_map;
}

Matrix6 Drift::covariance(const Pose& motion, const Matrix6& against_map) const {
  if (state_.is_anywhere) return unknown_covariance();
  return carried(state_.total(), motion) + against_map;
}

}  // namespace hqslam::slam
