#include "alignment/scan_information.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace hqslam::slam {

namespace {

/// The share of the constraints that wrong matches feign along a tunnel, of 16 or 64 rows: with
/// half of it squared errors are up to 700 times the covariance there (36 with it), with half as
/// much again the covariance of meadows is far too large (simulated tunnels of 5 m, meadows,
/// streets).
constexpr double kMismatchedShare = 0.002;
/// From six times what is feigned on all information counts.
constexpr double kKnownPerExcess = 0.2;

/// Sums over the constraints.
struct Sums {
  Matrix6 information = Matrix6::Zero();
  Matrix6 feigned = Matrix6::Zero();  ///< N
  Vector6 gradient = Vector6::Zero();
  double total = 0.0;  ///< of weight^2
};

Sums sums_of(const std::vector<PlaneConstraint>& constraints) {
  Sums sums;
  for (const PlaneConstraint& c : constraints) {
    Vector6 J;
    J << c.normal, c.point_m.cross(c.normal);
    J *= c.weight;
    sums.information += J.lazyProduct(J.transpose());
    sums.total += c.weight * c.weight;
    sums.gradient += c.weight * (c.normal.dot(c.point_m) - c.offset_m) * J;
    Vector6 J_tilt;
    J_tilt << c.tilt, c.point_m.cross(c.tilt);
    J_tilt *= c.weight;
    sums.feigned += J_tilt.lazyProduct(J_tilt.transpose());
  }
  return sums;
}

/// ScanInformation::known, in axes of the map. scale: makes lengths of all parameters.
Matrix6 known_information(const Sums& sums, const Vector6& scale) {
  const auto scaled = [&](const Matrix6& form) -> Matrix6 {
    return scale.asDiagonal() * form * scale.asDiagonal();
  };
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(scaled(sums.information));
  const Matrix6 feigned = scaled(sums.feigned);
  Vector6 known;
  for (int i = 0; i < 6; ++i) {
    const Vector6 u = solver.eigenvectors().col(i);
    const double all = solver.eigenvalues()[i];
    const double none = 2.0 * u.dot(feigned * u) + kMismatchedShare * sums.total;
    known[i] = all * std::clamp(kKnownPerExcess * (all / none - 1.0), 0.0, 1.0);
  }
  const Matrix6 directions = scale.cwiseInverse().asDiagonal() * solver.eigenvectors();
  return directions * known.asDiagonal() * directions.transpose();
}

}  // namespace

ScanInformation scan_information(const std::vector<PlaneConstraint>& constraints,
                                 const Eigen::Matrix3d& R_map_sensor) {
  const Sums sums = sums_of(constraints);
  Matrix6 turn = Matrix6::Zero();
  turn.topLeftCorner<3, 3>() = R_map_sensor;
  turn.bottomRightCorner<3, 3>() = R_map_sensor;
  Vector6 scale;
  scale << Eigen::Vector3d::Ones(), Eigen::Vector3d::Constant(1.0 / kLever_m);
  const Matrix6 scaled = scale.asDiagonal() * sums.information * scale.asDiagonal();
  return {turn.transpose() * sums.information * turn, turn.transpose() * sums.gradient,
          turn.transpose() * known_information(sums, scale) * turn,
          observability(scaled, sums.total, FreeParameters::kAll).degenerate_directions,
          sums.total * observability(scaled, sums.total, FreeParameters::kInPlane).share[0]};
}

ExpectedState::ExpectedState(const MotionState& expected)
    : expected_(expected), information_(expected.covariance.ldlt().solve(Matrix12::Identity())) {}

MotionState ExpectedState::improved(const MotionState& state, const ScanInformation& scan) const {
  Vector12 error;
  error << vector_of(logarithm(expected_.T_map_sensor.inverse() * state.T_map_sensor)),
      vector_of(state.velocity) - vector_of(expected_.velocity);
  Matrix12 information = information_;
  information.topLeftCorner<6, 6>() += scan.information;
  Vector12 gradient = information_ * error;
  gradient.head<6>() += scan.gradient;
  const Eigen::LDLT<Matrix12> solver(information);
  const Vector12 change = -solver.solve(gradient);
  MotionState result;
  result.T_map_sensor = state.T_map_sensor * exponential(twist_of(change.head<6>()));
  result.velocity = twist_of(vector_of(state.velocity) + Vector6(change.tail<6>()));
  Matrix12 known = information_;
  known.topLeftCorner<6, 6>() += scan.known;
  result.covariance = known.ldlt().solve(Matrix12::Identity());
  return result;
}

MotionState ExpectedState::given(const Pose& T_map_sensor) const {
  const Vector6 error = vector_of(logarithm(expected_.T_map_sensor.inverse() * T_map_sensor));
  const Vector6 change = expected_.covariance.bottomLeftCorner<6, 6>() *
                         expected_.covariance.topLeftCorner<6, 6>().ldlt().solve(error);
  MotionState result = expected_;
  result.T_map_sensor = T_map_sensor;
  result.velocity = twist_of(vector_of(expected_.velocity) + change);
  return result;
}

}  // namespace hqslam::slam
