#include "alignment/drift.h"

#include <algorithm>
#include <cmath>

namespace hqslam::slam {

namespace {

/// Of variances, with rows as far apart as those of an OS1-16.
constexpr double kAlongGround = 20.0;
constexpr double kHeight = 7.3;
constexpr double kTilt = 5.3;
constexpr double kHeading = 9.2;
constexpr double kSpacing_rad = 0.0368;
/// How they grow with the spacing.
constexpr double kSpacingPower = 0.75;
constexpr double kShare_per_m = 0.055;
/// Tilt at the start, of the spacing, and how long a start is.
constexpr double kStartTilt = 0.0244;
constexpr double kStart_m = 2.0;

/// From a measured row to the next, on the average.
double row_spacing_rad(const SensorModel& sensor) {
  const SensorModel measured =
      sensor.measured_rows ? select_rows(sensor, *sensor.measured_rows) : sensor;
  if (measured.rows() < 2) return kSpacing_rad;
  const auto [low, high] =
      std::minmax_element(measured.beam_elevation_rad.begin(), measured.beam_elevation_rad.end());
  return (*high - *low) / (measured.rows() - 1);
}

Matrix6 carried(const Matrix6& covariance, const Pose& motion) {
  const Matrix6 turn = adjoint(motion.inverse());
  return turn * covariance * turn.transpose();
}

}  // namespace

Drift::Drift(const SensorModel& sensor) {
  const double spacing_rad = row_spacing_rad(sensor);
  Vector6 variance;
  variance << kAlongGround, kAlongGround, kHeight, kTilt, kTilt, kHeading;
  factor_ = (std::pow(spacing_rad / kSpacing_rad, kSpacingPower) * variance).cwiseSqrt();
  start_variance_ = std::pow(kStartTilt * spacing_rad, 2);
}

Matrix6 Drift::against_map(const MotionState& state) const {
  return factor_.asDiagonal() * state.covariance.topLeftCorner<6, 6>() * factor_.asDiagonal();
}

void Drift::move(const Pose& motion) { drift_ = carried(drift_, motion); }

void Drift::locate(const Pose& motion, const MotionState& state) {
  move(motion);
  const double step_m = motion.translation().norm();
  const double begun = std::exp(-path_m_ / kStart_m) - std::exp(-(path_m_ + step_m) / kStart_m);
  drift_ += kShare_per_m * step_m * against_map(state);
  drift_.diagonal().segment<2>(3).array() += begun * start_variance_;
  path_m_ += step_m;
}

void Drift::lose(const MotionState& expected) {
  drift_ += expected.covariance.topLeftCorner<6, 6>();
}

Matrix6 Drift::covariance(const Pose& motion, const MotionState& state) const {
  return carried(drift_, motion) + against_map(state);
}

}  // namespace hqslam::slam
