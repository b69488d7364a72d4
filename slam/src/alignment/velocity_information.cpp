#include "alignment/velocity_information.h"

#include <Eigen/Cholesky>

namespace hqslam::slam {

namespace {

/// With 1 streets and meadows are up to a tenth less accurate, with 0.02 rooms and hands up to a
/// half (simulated drives; weights/NOTEBOOK.md, "What a hand does within a scan").
constexpr double kVelocityShare = 0.1;

/// Keeps S0 regular where a direction of the pose is unobservable; the velocity along it is as
/// well.
constexpr double kLeastInformation_per_m2 = 1e-6;

}  // namespace

VelocityInformation velocity_information(const std::vector<PlaneConstraint>& constraints,
                                         const Eigen::Matrix3d& R_map_sensor,
                                         const ScanInformation& about_pose) {
  Matrix6 S1 = Matrix6::Zero();
  Matrix6 S2 = Matrix6::Zero();
  Vector6 g1 = Vector6::Zero();
  for (const PlaneConstraint& c : constraints) {
    Vector6 J;
    J << c.normal, c.point_m.cross(c.normal);
    J *= c.weight;
    const Vector6 timed = c.time_offset_s * J;
    S1 += timed.lazyProduct(J.transpose());
    S2 += timed.lazyProduct(timed.transpose());
    g1 += c.weight * (c.normal.dot(c.point_m) - c.offset_m) * timed;
  }
  const Matrix6 turn = adjoint(Pose(R_map_sensor));
  S1 = turn.transpose() * S1 * turn;
  S2 = turn.transpose() * S2 * turn;
  g1 = turn.transpose() * g1;
  const Matrix6 S0 = about_pose.information + kLeastInformation_per_m2 * Matrix6::Identity();
  const Matrix6 lead = S0.ldlt().solve(S1);
  const Matrix6 V = S2 - S1 * lead;
  const Vector6 g = g1 - lead.transpose() * about_pose.gradient;
  return {S1, S2 - (1.0 - kVelocityShare) * V, g1 - (1.0 - kVelocityShare) * g};
}

}  // namespace hqslam::slam
