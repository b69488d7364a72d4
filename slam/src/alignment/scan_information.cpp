#include "alignment/scan_information.h"

#include <Eigen/Cholesky>

namespace hqslam::slam {

ScanInformation scan_information(const std::vector<PlaneConstraint>& constraints,
                                 const Eigen::Matrix3d& R_map_sensor) {
  Matrix6 sum = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  double total = 0.0;
  for (const PlaneConstraint& c : constraints) {
    Vector6 J;
    J << c.normal, c.point_m.cross(c.normal);
    J *= c.weight;
    sum += J.lazyProduct(J.transpose());
    total += c.weight * c.weight;
    gradient += c.weight * (c.normal.dot(c.point_m) - c.offset_m) * J;
  }
  Matrix6 turn = Matrix6::Zero();
  turn.topLeftCorner<3, 3>() = R_map_sensor;
  turn.bottomRightCorner<3, 3>() = R_map_sensor;
  Vector6 scale;
  scale << Eigen::Vector3d::Ones(), Eigen::Vector3d::Constant(1.0 / kLever_m);
  const Matrix6 scaled = scale.asDiagonal() * sum * scale.asDiagonal();
  return {turn.transpose() * sum * turn, turn.transpose() * gradient,
          observability(scaled, total, FreeParameters::kAll).degenerate_directions,
          total * observability(scaled, total, FreeParameters::kInPlane).share[0]};
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
  result.covariance = solver.solve(Matrix12::Identity());
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
