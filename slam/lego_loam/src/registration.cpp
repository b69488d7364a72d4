#include "registration.h"

#include <ceres/ceres.h>

#include <cmath>

#include "alignment/ceres_solver.h"
#include "hqslam/core/angles.h"

namespace hqslam::lego_loam {

namespace {

constexpr double kMinWeight = 0.1;

struct Distance {
  Constraint constraint;
  template <typename T>
  bool operator()(const T* out_of_plane, const T* in_plane, T* residual) const {
    using Vector = Eigen::Matrix<T, 3, 1>;
    const auto& [p, q, n, s, weight] = constraint;
    const Eigen::AngleAxis<T> roll(s * out_of_plane[1], Vector::UnitX());
    const Eigen::AngleAxis<T> pitch(s * out_of_plane[2], Vector::UnitY());
    const Eigen::AngleAxis<T> yaw(s * in_plane[2], Vector::UnitZ());
    const Vector t(in_plane[0], in_plane[1], out_of_plane[0]);
    const Vector moved = yaw * (pitch * (roll * Vector(p.cast<T>()))) + s * t;
    *residual = weight * n.dot(moved - q.cast<T>());
    return true;
  }
};

void take_steps(const Constraints& constraints, PoseParameters& pose, Free free, int steps) {
  ceres::Problem problem;
  for (const Constraint& constraint : constraints) {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<Distance, 1, 3, 3>(new Distance{constraint}), nullptr,
        pose.out_of_plane.data(), pose.in_plane.data());
  }
  if (free == Free::kOutOfPlane) problem.SetParameterBlockConstant(pose.in_plane.data());
  if (free == Free::kInPlane) problem.SetParameterBlockConstant(pose.out_of_plane.data());
  slam::solve(problem, slam::NormalEquations::kDense, steps);
}

}  // namespace

Pose pose_of(const PoseParameters& parameters, double s) {
  const auto& [out_of_plane, in_plane] = parameters;
  return pose_from_xyz_rpy(s * Eigen::Vector3d(in_plane[0], in_plane[1], out_of_plane[0]),
                           s * out_of_plane[1], s * out_of_plane[2], s * in_plane[2]);
}

PoseParameters parameters_of(const Pose& pose) {
  const Eigen::Vector3d t = pose.translation();
  const Eigen::Vector3d angle = roll_pitch_yaw_rad(pose);
  return {{t.z(), angle[0], angle[1]}, {t.x(), t.y(), angle[2]}};
}

void add_plane(Constraint plane, const Pose& T, double fall, Constraints& constraints) {
  const double distance_m = std::abs(plane.n.dot(T * plane.p - plane.q));
  plane.weight = 1.0 - fall * distance_m / std::sqrt(plane.p.norm());
  if (plane.weight > kMinWeight) constraints.push_back(plane);
}

void add_line(Constraint line, const Eigen::Vector3d& u, const Pose& T, double fall,
              Constraints& constraints) {
  line.weight = 1.0 - fall * (T * line.p - line.q).cross(u).norm();
  if (!(line.weight > kMinWeight) || u.isZero()) return;
  line.n = u.unitOrthogonal();
  constraints.push_back(line);
  line.n = u.cross(line.n);
  constraints.push_back(line);
}

int align(PoseParameters& pose, Free free, const Schedule& schedule, const FindConstraints& find) {
  int found = 0;
  for (int search = 0; search < schedule.searches; ++search) {
    const PoseParameters before = pose;
    const Constraints constraints = find(before, search);
    found = static_cast<int>(constraints.size());
    if (found < schedule.min_constraints) return 0;
    take_steps(constraints, pose, free, schedule.steps_per_search);
    const Pose step = pose_of(before).inverse() * pose_of(pose);
    if (step.translation().norm() < schedule.converged_m &&
        degrees(rotation_angle_rad(step)) < schedule.converged_deg) {
      break;
    }
  }
  return found;
}

}  // namespace hqslam::lego_loam
