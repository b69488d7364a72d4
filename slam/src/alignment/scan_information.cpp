#include "alignment/scan_information.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

#include "alignment/velocity_information.h"

namespace hqslam::slam {

namespace {

/// The share of all constraints up to which wrong matches explain information, along a tunnel and
/// with 16 or 64 rows: with half of it squared errors are up to 700 times the covariance there (36
/// with it), with half as much again the covariance of meadows is far too large (simulated tunnels
/// of 5 m, meadows, streets).
constexpr double kMismatchedShare = 0.002;
/// Information of six times b and more (known_information) is known in full (the same tunnels).
constexpr double kKnownPerExcess = 0.2;

/// Scales that make lengths of all parameters.
Vector6 to_lengths() { return six(1.0, 1.0 / kLever_m); }

Matrix6 scaled(const Matrix6& form) {
  const Vector6 scale = to_lengths();
  return scale.asDiagonal() * form * scale.asDiagonal();
}

/// weight (n, p x n) for the normal of a constraint, or its tilt in the place of n.
Vector6 row_of(const PlaneConstraint& c, const Eigen::Vector3d& n) {
  Vector6 row;
  row << n, c.point_m.cross(n);
  return row * c.weight;
}

}  // namespace

ScanInformation scan_information(const std::vector<PlaneConstraint>& constraints,
                                 const Eigen::Matrix3d& R_map_sensor) {
  Matrix6 information = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  double total = 0.0;
  for (const PlaneConstraint& c : constraints) {
    const Vector6 J = row_of(c, c.normal);
    information += J.lazyProduct(J.transpose());
    gradient += c.weight * (c.normal.dot(c.point_m) - c.offset_m) * J;
    total += c.weight * c.weight;
  }
  const Matrix6 turn = adjoint(Pose(R_map_sensor));
  const Matrix6 lengths = scaled(information);
  return {turn.transpose() * information * turn, turn.transpose() * gradient,
          observability(lengths, total, FreeParameters::kAll).degenerate_directions,
          total * observability(lengths, total, FreeParameters::kInPlane).share[0]};
}

KnownInformation known_information(const std::vector<PlaneConstraint>& constraints,
                                   const Eigen::Matrix3d& R_map_sensor) {
  Matrix6 information = Matrix6::Zero();
  Matrix6 explained = Matrix6::Zero();  // N
  double total = 0.0;
  for (const PlaneConstraint& c : constraints) {
    const Vector6 J = row_of(c, c.normal);
    const Vector6 J_tilt = row_of(c, c.tilt);
    information += J.lazyProduct(J.transpose());
    explained += J_tilt.lazyProduct(J_tilt.transpose());
    total += c.weight * c.weight;
  }
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(scaled(information));
  explained = scaled(explained);
  Vector6 known;
  for (int i = 0; i < 6; ++i) {
    const Vector6 u = solver.eigenvectors().col(i);
    const double all = solver.eigenvalues()[i];
    const double none = 2.0 * u.dot(explained * u) + kMismatchedShare * total;
    known[i] = all * std::clamp(kKnownPerExcess * (all / none - 1.0), 0.0, 1.0);
  }
  const Matrix6 directions = to_lengths().cwiseInverse().asDiagonal() * solver.eigenvectors();
  const Matrix6 turn = adjoint(Pose(R_map_sensor));
  return {
      turn.transpose() * Matrix6(directions * known.asDiagonal() * directions.transpose()) * turn,
      known.minCoeff() > 0.0};
}

ExpectedState::ExpectedState(const MotionState& expected)
    : expected_(expected), information_(expected.covariance.ldlt().solve(Matrix12::Identity())) {}

void ExpectedState::improve(MotionState& state, const ScanInformation& scan,
                            const VelocityInformation* velocity) const {
  Vector12 error;
  error << vector_of(logarithm(expected_.T_map_sensor.inverse() * state.T_map_sensor)),
      vector_of(state.velocity) - vector_of(expected_.velocity);
  Matrix12 information = information_;
  information.topLeftCorner<6, 6>() += scan.information;
  Vector12 gradient = information_ * error;
  gradient.head<6>() += scan.gradient;
  if (velocity != nullptr) {
    information.topRightCorner<6, 6>() += velocity->with_pose;
    information.bottomLeftCorner<6, 6>() += velocity->with_pose.transpose();
    information.bottomRightCorner<6, 6>() += velocity->of_velocity;
    gradient.tail<6>() += velocity->gradient;
  }
  const Vector12 change = -information.ldlt().solve(gradient);
  state.T_map_sensor = state.T_map_sensor * exponential(twist_of(change.head<6>()));
  put_velocity(vector_of(state.velocity) + change.tail<6>(), state);
}

void ExpectedState::put_velocity(const Vector6& velocity, MotionState& state) const {
  state.velocity = twist_of(velocity);
  if (!expected_.measured_step_s) return;
  state.acceleration =
      twist_of((velocity - vector_of(expected_.velocity)) / *expected_.measured_step_s);
}

Matrix12 ExpectedState::covariance(const Matrix6& known) const {
  Matrix12 information = information_;
  information.topLeftCorner<6, 6>() += known;
  return information.ldlt().solve(Matrix12::Identity());
}

MotionState ExpectedState::given(const Pose& T_map_sensor) const {
  const Vector6 error = vector_of(logarithm(expected_.T_map_sensor.inverse() * T_map_sensor));
  const Vector6 change = expected_.covariance.bottomLeftCorner<6, 6>() *
                         expected_.covariance.topLeftCorner<6, 6>().ldlt().solve(error);
  MotionState result = expected_;
  result.T_map_sensor = T_map_sensor;
  put_velocity(vector_of(expected_.velocity) + change, result);
  return result;
}

}  // namespace hqslam::slam
