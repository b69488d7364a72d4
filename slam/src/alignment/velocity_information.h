#pragma once

#include <vector>

#include "alignment/rigid_alignment.h"
#include "alignment/scan_information.h"

namespace hqslam::slam {

/// The information of a scan about the sensor's velocity, which shows in the points' times of
/// capture. With the error e of the pose and that v of the velocity, both (linear, angular) in the
/// sensor's frame, it adds to the quadratic form of ScanInformation
///   e^T with_pose v + v^T of_velocity v / 2 + gradient^T v.
struct VelocityInformation {
  Matrix6 with_pose = Matrix6::Zero();
  Matrix6 of_velocity = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
};

/// In: constraints with the times of their points, in axes of the map with the sensor as origin;
/// its orientation; scan_information() of these.
///
/// A wrong velocity v moves a point that was captured t after the stamp as an error t v of the pose
/// does (MotionCorrection, to first order in the turn within the scan). So, with r and J of
/// ScanInformation,
///   S1 = sum of t J J^T,  S2 = sum of t^2 J J^T,  g1 = sum of t r J.
/// What remains about v once the pose is estimated, V = S2 - S1 S0^-1 S1 with S0 the information
/// about the pose, counts by kVelocityShare alone: errors of neighbouring points are correlated,
/// and these were captured at nearly the same time.
VelocityInformation velocity_information(const std::vector<PlaneConstraint>& constraints,
                                         const Eigen::Matrix3d& R_map_sensor,
                                         const ScanInformation& about_pose);

}  // namespace hqslam::slam
