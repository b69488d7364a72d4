#include "alignment/rigid_alignment.h"

#include <ceres/ceres.h>

#include <Eigen/Eigenvalues>

#include "alignment/ceres_solver.h"
#include "alignment/motion_state.h"
#include "alignment/rotation_derivatives.h"

namespace hqslam::slam {

namespace {

/// Places in (x, y, z, roll, pitch, yaw) that are not estimated.
std::vector<int> held_parameters(FreeParameters free) {
  if (free == FreeParameters::kInPlane) return {2, 3, 4};
  if (free == FreeParameters::kOutOfPlane) return {0, 1, 5};
  return {};
}

/// All constraints as one batched residual.
class PlaneConstraintsCost : public ceres::CostFunction {
 public:
  explicit PlaneConstraintsCost(const std::vector<PlaneConstraint>& constraints)
      : constraints_(constraints) {
    set_num_residuals(static_cast<int>(constraints.size()));
    mutable_parameter_block_sizes()->assign({3, 3});
  }
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    evaluate(constraints_, parameters, residuals, jacobians);
    return true;
  }

 private:
  const std::vector<PlaneConstraint>& constraints_;
};

}  // namespace

EdgeConstraints edge_constraints(const Eigen::Vector3d& point_m, const Eigen::Vector3d& on_line_m,
                                 const Eigen::Vector3d& direction, double weight) {
  const Eigen::Vector3d a = direction.unitOrthogonal();
  const Eigen::Vector3d b = direction.cross(a);
  return {{{point_m, a, a.dot(on_line_m), weight}, {point_m, b, b.dot(on_line_m), weight}}};
}

void ConstraintList::add(const std::vector<std::optional<EdgeConstraints>>& found) {
  for (const auto& edge : found) {
    if (!edge) continue;
    all.insert(all.end(), edge->begin(), edge->end());
    ++edges;
  }
}

void ConstraintList::add(const std::vector<std::optional<PlaneConstraint>>& found) {
  for (const auto& plane : found) {
    if (!plane) continue;
    all.push_back(*plane);
    ++planes;
  }
}

Pose pose_of(const MotionParameters& p) {
  return pose_from_xyz_rpy({p[0], p[1], p[3]}, p[4], p[5], p[2]);
}

MotionParameters parameters_of(const Pose& pose) {
  const Eigen::Vector3d angles_rad = roll_pitch_yaw_rad(pose);
  MotionParameters result;
  result << pose.translation().head<2>(), angles_rad.z(), pose.translation().z(),
      angles_rad.head<2>();
  return result;
}

void evaluate(const std::vector<PlaneConstraint>& constraints, double const* const* parameters,
              double* residuals, double** jacobians) {
  const double* in_plane = parameters[0];
  const double* out_of_plane = parameters[1];
  const RotationWithDerivatives rotation(out_of_plane[1], out_of_plane[2], in_plane[2]);
  const Eigen::Vector3d translation_m(in_plane[0], in_plane[1], out_of_plane[0]);
  double* in_plane_row = jacobians != nullptr ? jacobians[0] : nullptr;
  double* out_of_plane_row = jacobians != nullptr ? jacobians[1] : nullptr;
  for (const PlaneConstraint& c : constraints) {
    const Eigen::Vector3d moved_m = rotation.R * c.point_m + translation_m;
    *residuals++ = c.weight * (c.normal.dot(moved_m) - c.offset_m);
    const Eigen::Vector3d n = c.weight * c.normal;
    if (in_plane_row != nullptr) {
      *in_plane_row++ = n.x();
      *in_plane_row++ = n.y();
      *in_plane_row++ = n.dot(rotation.dR_dyaw * c.point_m);
    }
    if (out_of_plane_row != nullptr) {
      *out_of_plane_row++ = n.z();
      *out_of_plane_row++ = n.dot(rotation.dR_droll * c.point_m);
      *out_of_plane_row++ = n.dot(rotation.dR_dpitch * c.point_m);
    }
  }
}

MotionParameters align(const std::vector<PlaneConstraint>& constraints,
                       const MotionParameters& start, FreeParameters free, int max_steps) {
  MotionParameters result = start;
  if (constraints.empty()) return result;
  double* in_plane = result.data();
  double* out_of_plane = in_plane + 3;
  ceres::Problem problem;
  problem.AddResidualBlock(new PlaneConstraintsCost(constraints), nullptr, in_plane, out_of_plane);
  if (free == FreeParameters::kOutOfPlane) problem.SetParameterBlockConstant(in_plane);
  if (free == FreeParameters::kInPlane) problem.SetParameterBlockConstant(out_of_plane);
  return solve(problem, NormalEquations::kDense, max_steps) ? result : start;
}

Observability observability(const std::vector<PlaneConstraint>& constraints, FreeParameters free) {
  Matrix6 information = Matrix6::Zero();
  double total = 0.0;
  for (const PlaneConstraint& c : constraints) {
    Vector6 row;
    row << c.normal, c.point_m.cross(c.normal) / kLever_m;
    row *= c.weight;
    information += row.lazyProduct(row.transpose());
    total += c.weight * c.weight;
  }
  return observability(information, total, free);
}

Observability observability(Matrix6 information, double total, FreeParameters free) {
  // Held parameters get the largest possible eigenvalue.
  for (const int held : held_parameters(free)) {
    information.row(held).setZero();
    information.col(held).setZero();
    information(held, held) = total;
  }
  Observability result;
  if (!(total > 0.0)) {
    result.degenerate_directions = 6 - static_cast<int>(held_parameters(free).size());
    result.projection.setZero();
    return result;
  }
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(information / total);
  result.share = solver.eigenvalues();
  result.direction = solver.eigenvectors();
  const Vector6 scale = six(1.0, kLever_m);
  for (int i = 0; i < 6; ++i) {
    if (solver.eigenvalues()[i] >= kMinObservableShare) continue;
    ++result.degenerate_directions;
    // The change in scaled units is scale * change; its component along the direction is removed.
    const Vector6 direction = solver.eigenvectors().col(i);
    result.projection -= (scale.cwiseInverse().asDiagonal() * direction) *
                         (scale.asDiagonal() * direction).transpose();
  }
  return result;
}

MotionParameters without_unobservable(const MotionParameters& start, const MotionParameters& end,
                                      const Observability& observability) {
  constexpr std::array kAsProjected = {0, 1, 3, 4, 5, 2};  // x, y, z, roll, pitch, yaw
  MotionParameters result = start;
  result(kAsProjected) += observability.projection * Vector6((end - start)(kAsProjected));
  return result;
}

}  // namespace hqslam::slam
