#pragma once

#include <cstddef>
#include <vector>

#include "hqslam/core/pose.h"
#include "imu/felt_gravity.h"

namespace hqslam::slam {

/// What was felt at a node of a path.
struct GravityAtNode {
  std::size_t node = 0;
  FeltGravity felt;
};

/// Keeps the vertical. A scan that is registered in a map of the scans before it leans as they do,
/// and beams that are off add a little with every metre, the same way in the sensor's frame: a
/// degree in a hundred metres. Gravity does not lean. But an accelerometer is off by as much as a
/// path leans (10 mg are 0.6 degrees); while the sensor goes straight the two look the same, and
/// its turns part them. So all of a path is levelled at once, backwards too.
///
///   minimise  sum over measurements |R_i^T exp(l_i)^T g - L_i b_i - M_i m - z_i|^2 / sigma_i^2
///             + sum |l_i - l_(i-1) - A_i d|^2 / (sigma_l^2 t_i)  + sum |b_i - b_(i-1)|^2 /
///             (sigma_b^2 t_i)
///             + |b_0|^2 / sigma_b0^2 + |d|^2 / sigma_d^2 + |m|^2 / sigma_m^2
///             + (|g| - 9.81)^2 / sigma_g^2
///
/// with the lean l_i of a node with rotation R_i (R_true = exp(l) R, map frame; none at the first
/// node), the bias b_i of the accelerometer, which walks, what a metre of path adds to the lean, d
/// (sensor frame), the inertial sensor's errors m, A_i = the integral of R over the
/// path since the measurement before, t_i the time since, and gravity g. About the vertical nothing
/// turns. Ceres, sparse Cholesky: time is linear in the length of the path.
///
/// In: poses of nodes along a path, as they were registered one after the other, and what was felt
/// at some (rising). Out: the poses upright, the first as it is: each turned by its lean (between
/// measurements in equal parts by path, after the last by d), with the motions in the sensors'
/// frames as they are.
std::vector<Pose> levelled(const std::vector<Pose>& T_first_node,
                           const std::vector<GravityAtNode>& gravity);

}  // namespace hqslam::slam
