#include "drift.h"

namespace hqslam::slam {

namespace {

constexpr double kCorrelation = 10.0;
constexpr double kShare_per_m = 0.02;

Matrix6 against_map(const MotionState& state) {
  return kCorrelation * state.covariance.topLeftCorner<6, 6>();
}

}  // namespace

void Drift::locate(const Pose& motion, const MotionState& state) {
  const Matrix6 turn = adjoint(motion.inverse());
  const double step_m = motion.translation().norm();
  drift_ = (turn * drift_ * turn.transpose() + kShare_per_m * step_m * against_map(state)).eval();
}

void Drift::lose(const MotionState& expected) {
  drift_ += expected.covariance.topLeftCorner<6, 6>();
}

Matrix6 Drift::covariance(const MotionState& state) const { return drift_ + against_map(state); }

}  // namespace hqslam::slam
