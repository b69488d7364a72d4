#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "hqslam/core/pose.h"
#include "imu/felt_gravity.h"

namespace hqslam::slam {

/// Gravity measured at a node of a path.
struct GravityAtNode {
  std::size_t node = 0;
  FeltGravity felt;
};

/// Levels a path by gravity. A scan registered in the map of the scans before it inherits their
/// tilt, and beam errors add to it with every metre, with a constant direction in the sensor's
/// frame: a degree in a hundred metres. An accelerometer's bias has the same order (10 mg are 0.6
/// degrees) and can be separated from the tilt only where the sensor turns, so all of a path is
/// levelled at once, including its past.
///
///   minimise  sum over measurements |R_i^T exp(l_i)^T g - L_i b_i - M_i m - z_i|^2 / sigma_i^2
///             + sum |l_i - l_(i-1) - A_i d|^2 / (sigma_l^2 t_i)  + sum |b_i - b_(i-1)|^2 /
///             (sigma_b^2 t_i)
///             + |b_0|^2 / sigma_b0^2 + |d|^2 / sigma_d^2 + |m|^2 / sigma_m^2
///             + (|g| - 9.81)^2 / sigma_g^2
///
/// with the lean l_i of a node with rotation R_i (R_true = exp(l) R, map frame; none at the first
/// node), the bias b_i of the accelerometer, a random walk, the lean per metre of path d (sensor
/// frame), the ImuErrors m, A_i = the integral of R over the path since the measurement before, t_i
/// the time since, and gravity g. The yaw does not change. Ceres, sparse Cholesky: time is linear
/// in the length of the path.
///
/// In: poses of nodes along a path, each registered relative to the one before, and gravity at some
/// (rising). Out: the levelled poses, the first unchanged: each turned by its lean (interpolated
/// along the path between measurements, after the last by d), with the translations in the sensors'
/// frames unchanged. Nothing where no path explains what was measured: the inertial sensor moved on
/// the vehicle, or its bias jumped.
std::optional<std::vector<Pose>> levelled(const std::vector<Pose>& T_first_node,
                                          const std::vector<GravityAtNode>& gravity);

}  // namespace hqslam::slam
