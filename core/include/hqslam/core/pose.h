#pragma once

#include <Eigen/Geometry>

namespace hqslam {

/// A rigid transform, metres. `T_map_sensor * p_sensor = p_map`.
using Pose = Eigen::Isometry3d;

/// Rotation by roll about x, then pitch about y, then yaw about z: R = Rz(yaw) Ry(pitch) Rx(roll).
Pose pose_from_xyz_rpy(const Eigen::Vector3d& translation_m, double roll_rad, double pitch_rad,
                       double yaw_rad);

/// (roll, pitch, yaw) in radians with R = Rz(yaw) Ry(pitch) Rx(roll), pitch in [-pi/2, pi/2].
Eigen::Vector3d roll_pitch_yaw_rad(const Pose& pose);

/// The angle of the pose's rotation, 0..pi.
double rotation_angle_rad(const Pose& pose);

/// On the straight line from `a` (fraction 0) to `b` (fraction 1): linear in translation, spherical
/// in rotation. Fractions outside 0..1 extrapolate.
Pose interpolate(const Pose& a, const Pose& b, double fraction);

/// The same pose with its rotation matrix made orthonormal again; for long products of poses.
Pose orthonormalized(const Pose& pose);

}  // namespace hqslam
