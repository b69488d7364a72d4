#pragma once

#include <Eigen/Geometry>

namespace hqslam::slam {

/// cross_matrix(a) b = a x b
inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// R = Rz(yaw) Ry(pitch) Rx(roll) and its derivatives:
///   d exp(angle [axis]) / d angle = [axis] exp(angle [axis]).
struct RotationWithDerivatives {
  Eigen::Matrix3d R, dR_droll, dR_dpitch, dR_dyaw;

  RotationWithDerivatives(double roll_rad, double pitch_rad, double yaw_rad) {
    const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
    const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
    const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
    const Eigen::Matrix3d Rx = Eigen::AngleAxisd(roll_rad, x).toRotationMatrix();
    const Eigen::Matrix3d Ry = Eigen::AngleAxisd(pitch_rad, y).toRotationMatrix();
    const Eigen::Matrix3d Rz = Eigen::AngleAxisd(yaw_rad, z).toRotationMatrix();
    R = Rz * Ry * Rx;
    dR_droll = Rz * Ry * cross_matrix(x) * Rx;
    dR_dpitch = Rz * cross_matrix(y) * Ry * Rx;
    dR_dyaw = cross_matrix(z) * R;
  }
};

}  // namespace hqslam::slam
