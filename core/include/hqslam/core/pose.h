#pragma once

#include <Eigen/Geometry>

namespace hqslam {

/// A rigid transform, metres. `T_map_sensor * p_sensor = p_map`. Not aligned, so that its size and
/// alignment do not depend on the flags that a program is compiled with (docs/library.md).
using Pose = Eigen::Transform<double, 3, Eigen::Isometry, Eigen::DontAlign>;

/// Rotation by roll about x, then pitch about y, then yaw about z: R = Rz(yaw) Ry(pitch) Rx(roll).
Pose pose_from_xyz_rpy(const Eigen::Vector3d& translation_m, double roll_rad, double pitch_rad,
                       double yaw_rad);

/// (roll, pitch, yaw) in radians with R = Rz(yaw) Ry(pitch) Rx(roll), pitch in [-pi/2, pi/2].
Eigen::Vector3d roll_pitch_yaw_rad(const Pose& pose);

/// The angle of the pose's rotation, 0..pi.
double rotation_angle_rad(const Pose& pose);

/// A motion as a screw, in the frame that moves: translation and rotation vector, or their rates. A
/// car that drives along a curve has a constant twist forward and about its vertical.
struct Twist {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();   ///< metres, or metres a second
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();  ///< radians, or radians a second
};
inline Twist operator*(double factor, const Twist& twist) {
  return {factor * twist.linear, factor * twist.angular};
}

/// The motion of a constant twist over one unit of time: the exponential of SE(3).
///   R = exp([w]),  t = V v,  V = I + (1 - cos a) / a^2 [w] + (a - sin a) / a^3 [w]^2,  a = |w|.
/// Source: Eade, "Lie groups for 2D and 3D transformations", section 3.
Pose exponential(const Twist& twist);
/// The twist that moves by `pose` in one unit of time, rotation at most pi: `exponential` undone.
Twist logarithm(const Pose& pose);

/// The pose on the screw motion, one of constant twist, from `a` (fraction 0) to `b` (fraction 1).
/// Fractions outside 0..1 extrapolate.
Pose interpolate(const Pose& a, const Pose& b, double fraction);

/// The pose with its rotation matrix made orthonormal again; for long products of poses.
Pose orthonormalized(const Pose& pose);

}  // namespace hqslam
