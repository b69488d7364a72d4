#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <array>

#include "alignment/rotation_derivatives.h"
#include "hqslam/core/pose.h"

namespace hqslam::slam::as_published {

/// A pose as roll, pitch, yaw (radians), x, y, z (metres): R = Rz(yaw) Ry(pitch) Rx(roll).
using Parameters = Eigen::Matrix<double, 6, 1>;

inline Pose pose_of(const Parameters& p) {
  return pose_from_xyz_rpy(p.tail<3>(), p(0), p(1), p(2));
}

inline Parameters parameters_of(const Pose& pose) {
  Parameters p;
  p << roll_pitch_yaw_rad(pose), pose.translation();
  return p;
}

/// dR/droll, dR/dpitch, dR/dyaw.
inline std::array<Eigen::Matrix3d, 3> rotation_derivatives(const Parameters& p) {
  const RotationWithDerivatives rotation(p(0), p(1), p(2));
  return {rotation.dR_droll, rotation.dR_dpitch, rotation.dR_dyaw};
}

/// A distance from a line or plane with its unit gradient in space, both times a weight.
struct WeightedDistance {
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double distance_m = 0.0;
};

/// Gauss-Newton steps over N parameters, of which the first step decides which directions count.
///
/// Solves A^T A x = - gain A^T d. In the first step the eigenvectors of A^T A are taken in the
/// order of rising eigenvalues; those before the first eigenvalue that reaches min_eigenvalue are
/// projected out, of this step and of all that follow.
template <int N>
class PublishedSteps {
 public:
  using Vector = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;

  PublishedSteps(double gain, double min_eigenvalue)
      : gain_(gain), min_eigenvalue_(min_eigenvalue) {}

  void add(const Vector& row, double distance_m) {
    AtA_ += row * row.transpose();
    Atd_ += row * distance_m;
  }

  /// Forgets what was added since the last step.
  void discard() {
    AtA_.setZero();
    Atd_.setZero();
  }

  /// The step from what was added since the last.
  Vector take() {
    if (first_) project_out();
    first_ = false;
    const Vector step = projection_ * AtA_.colPivHouseholderQr().solve(-gain_ * Atd_);
    discard();
    return step.allFinite() ? step : Vector(Vector::Zero());
  }

 private:
  void project_out() {
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(AtA_);
    for (int i = 0; i < N && eigen.eigenvalues()(i) < min_eigenvalue_; ++i) {
      const Vector direction = eigen.eigenvectors().col(i);
      projection_ -= direction * direction.transpose();
    }
  }

  double gain_;
  double min_eigenvalue_;
  bool first_ = true;
  Matrix AtA_ = Matrix::Zero();
  Vector Atd_ = Vector::Zero();
  Matrix projection_ = Matrix::Identity();
};

/// Distance of p from the line through a and b.
inline WeightedDistance distance_from_line(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                           const Eigen::Vector3d& b) {
  const Eigen::Vector3d along = (b - a).normalized();
  const Eigen::Vector3d off = (p - a) - along * along.dot(p - a);
  const double distance_m = off.norm();
  return {distance_m > 0.0 ? Eigen::Vector3d(off / distance_m) : Eigen::Vector3d::Zero(),
          distance_m};
}

inline WeightedDistance weighed(const WeightedDistance& distance, double weight) {
  return {weight * distance.gradient, weight * distance.distance_m};
}

constexpr double kMinWeight = 0.1;

}  // namespace hqslam::slam::as_published
