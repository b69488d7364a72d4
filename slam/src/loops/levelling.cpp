#include "loops/levelling.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "alignment/ceres_solver.h"
#include "alignment/motion_state.h"
#include "hqslam/core/imu_sample.h"

namespace hqslam::slam {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Standard deviations; of random walks per root of a second. Twice or half the walks changes the
// drift of simulated drives by a tenth.
constexpr double kBiasWalk_mps2 = 3e-3;
constexpr double kFirstBias_mps2 = 0.2;
constexpr double kGravityNorm_mps2 = 0.02;
constexpr double kLeanWalk_rad = 3.5e-4;
constexpr double kLean_rad_per_m = 1.7e-4;
/// ImuErrors of a carefully mounted sensor, checked on simulated drives alone.
constexpr std::array<double, 8> kImuErrors = {0.015, 0.015, 0.015, 0.01, 0.15, 0.15, 0.15, 0.005};
/// Factor of the sigmas about the vertical, which keeps the yaw.
constexpr double kAboutVertical = 0.01;
constexpr int kMaxSteps = 50;
/// Largest difference of a measured gravity from that of the solution, in standard deviations.
/// Right data: at most 1.1; a bracket that bends by a degree on the way 2.7 to 4.7, by three 6 to 8
/// (simulated drives).
constexpr double kMostDifference = 2.0;

/// The unknowns at one node with a measurement.
struct Measurement {
  Vector3d lean_rad = Vector3d::Zero();
  Vector3d bias_mps2 = Vector3d::Zero();
};

struct Unknowns {
  std::vector<Measurement> measurements;
  Vector3d gravity_mps2 = Vector3d::Zero();
  Vector3d lean_rad_per_m = Vector3d::Zero();
  ImuErrors imu_errors = ImuErrors::Zero();
};

template <typename T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

template <typename T>
Eigen::Map<const Vector3<T>> vector_at(const T* values) {
  return Eigen::Map<const Vector3<T>>(values);
}

/// The first term.
struct FeltResidual {
  Matrix3d R_sensor_map;
  FeltGravity felt;

  template <typename T>
  bool operator()(const T* lean, const T* bias, const T* imu_errors, const T* gravity,
                  T* residual) const {
    const Vector3<T> back = -vector_at(lean);
    Vector3<T> upright;
    ceres::AngleAxisRotatePoint(back.data(), gravity, upright.data());
    Eigen::Map<Vector3<T>> r(residual);
    r = (R_sensor_map * upright - felt.of_bias * vector_at(bias) -
         felt.of_errors * Eigen::Map<const Eigen::Matrix<T, 8, 1>>(imu_errors) -
         felt.gravity_mps2) /
        T(felt.sigma_mps2);
    return true;
  }
};

/// The second and the third term.
struct WalkResidual {
  Matrix3d path_m;  ///< A
  double root_of_s = 1.0;

  template <typename T>
  bool operator()(const T* lean_before, const T* lean, const T* bias_before, const T* bias,
                  const T* per_m, T* residual) const {
    Eigen::Map<Vector3<T>> of_lean(residual);
    Eigen::Map<Vector3<T>> of_bias(residual + 3);
    of_lean = (vector_at(lean) - vector_at(lean_before) - path_m * vector_at(per_m)) /
              T(kLeanWalk_rad * root_of_s);
    of_lean.z() /= T(kAboutVertical);
    of_bias = (vector_at(bias) - vector_at(bias_before)) / T(kBiasWalk_mps2 * root_of_s);
    return true;
  }
};

/// The last two lines.
struct PriorResidual {
  template <typename T>
  bool operator()(const T* bias, const T* per_m, const T* imu_errors, const T* gravity,
                  T* residual) const {
    Eigen::Map<Vector3<T>> of_bias(residual);
    Eigen::Map<Vector3<T>> of_lean(residual + 3);
    of_bias = vector_at(bias) / T(kFirstBias_mps2);
    of_lean = vector_at(per_m) / T(kLean_rad_per_m);
    of_lean.z() /= T(kAboutVertical);
    for (int i = 0; i < 8; ++i) residual[7 + i] = imu_errors[i] / T(kImuErrors[i]);
    residual[6] = (vector_at(gravity).norm() - kGravity_mps2) / T(kGravityNorm_mps2);
    return true;
  }
};

/// The integral of R along the path from one node to another.
Matrix3d integral_of_turn(const std::vector<Pose>& T_first_node, std::size_t from, std::size_t to) {
  Matrix3d result = Matrix3d::Zero();
  for (std::size_t i = from; i < to; ++i) {
    result += distance_m(T_first_node[i + 1], T_first_node[i]) * T_first_node[i].linear();
  }
  return result;
}

/// Whether the solution explains all measurements.
bool explains(const std::vector<Pose>& T_first_node, const std::vector<GravityAtNode>& gravity,
              const Unknowns& unknowns) {
  for (std::size_t i = 0; i < gravity.size(); ++i) {
    const FeltResidual felt{T_first_node[gravity[i].node].linear().transpose(), gravity[i].felt};
    const Measurement& at = unknowns.measurements[i];
    Vector3d difference;
    felt(at.lean_rad.data(), at.bias_mps2.data(), unknowns.imu_errors.data(),
         unknowns.gravity_mps2.data(), difference.data());
    if (!(difference.norm() < kMostDifference)) return false;
  }
  return true;
}

/// False if Ceres found no solution.
bool solve(const std::vector<Pose>& T_first_node, const std::vector<GravityAtNode>& gravity,
           Unknowns& unknowns) {
  ceres::Problem problem;
  double* per_m = unknowns.lean_rad_per_m.data();
  double* gravity_mps2 = unknowns.gravity_mps2.data();
  Measurement first;  // at the first node, which does not lean
  problem.AddParameterBlock(first.lean_rad.data(), 3);
  problem.SetParameterBlockConstant(first.lean_rad.data());
  for (std::size_t i = 0; i < gravity.size(); ++i) {
    const auto& [node, felt] = gravity[i];
    Measurement& before = i == 0 ? first : unknowns.measurements[i - 1];
    Measurement& now = unknowns.measurements[i];
    const std::size_t node_before = i == 0 ? 0 : gravity[i - 1].node;
    // Clocks may be set back.
    const double time_s = i == 0 ? 3.0 : std::max(1.0, felt.stamp_s - gravity[i - 1].felt.stamp_s);
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<WalkResidual, 6, 3, 3, 3, 3, 3>(
            new WalkResidual{integral_of_turn(T_first_node, node_before, node), std::sqrt(time_s)}),
        nullptr, before.lean_rad.data(), now.lean_rad.data(), before.bias_mps2.data(),
        now.bias_mps2.data(), per_m);
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<FeltResidual, 3, 3, 3, 8, 3>(
                                 new FeltResidual{T_first_node[node].linear().transpose(), felt}),
                             nullptr, now.lean_rad.data(), now.bias_mps2.data(),
                             unknowns.imu_errors.data(), gravity_mps2);
  }
  problem.AddResidualBlock(
      new ceres::AutoDiffCostFunction<PriorResidual, 15, 3, 3, 8, 3>(new PriorResidual), nullptr,
      first.bias_mps2.data(), per_m, unknowns.imu_errors.data(), gravity_mps2);
  return slam::solve(problem, NormalEquations::kSparse, kMaxSteps);
}

}  // namespace

std::optional<std::vector<Pose>> levelled(const std::vector<Pose>& T_first_node,
                                          const std::vector<GravityAtNode>& gravity) {
  if (gravity.empty()) return T_first_node;
  Unknowns unknowns;
  unknowns.measurements.resize(gravity.size());
  unknowns.gravity_mps2 =
      T_first_node[gravity.front().node].linear() * gravity.front().felt.gravity_mps2;
  const bool is_solved = solve(T_first_node, gravity, unknowns);
  if (!is_solved || !explains(T_first_node, gravity, unknowns)) return std::nullopt;
  std::vector<double> path_m{0.0};
  for (std::size_t i = 1; i < T_first_node.size(); ++i) {
    path_m.push_back(path_m.back() + distance_m(T_first_node[i], T_first_node[i - 1]));
  }
  std::vector<Pose> result{T_first_node.front()};
  Vector3d lean_rad = Vector3d::Zero();
  std::size_t next = 0;  // measurement
  for (std::size_t i = 1; i < T_first_node.size(); ++i) {
    while (next < gravity.size() && gravity[next].node < i) ++next;
    if (next == gravity.size()) {
      lean_rad += integral_of_turn(T_first_node, i - 1, i) * unknowns.lean_rad_per_m;
    } else if (path_m[gravity[next].node] > path_m[i - 1]) {
      const double share =
          (path_m[i] - path_m[i - 1]) / (path_m[gravity[next].node] - path_m[i - 1]);
      lean_rad += share * (unknowns.measurements[next].lean_rad - lean_rad);
    }
    const Pose motion = T_first_node[i - 1].inverse() * T_first_node[i];
    Pose upright;
    upright.linear() = rotation_of(lean_rad) * T_first_node[i].linear();
    upright.translation() = result.back() * motion.translation();
    result.push_back(orthonormalized(upright));
  }
  return result;
}

}  // namespace hqslam::slam
