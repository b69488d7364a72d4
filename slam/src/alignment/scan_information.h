#pragma once

#include "alignment/motion_state.h"
#include "alignment/rigid_alignment.h"

namespace hqslam::slam {

/// The information of a scan about the sensor's pose, as a quadratic form of the change e =
/// (linear, angular) in the sensor's frame, T <- T exp(e):  e^T information e / 2 + gradient^T e.
struct ScanInformation {
  Matrix6 information = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  int degenerate_directions = 0;  ///< Observability, of all parameters
  /// 1 / sigma^2 [1/m^2] of the least known direction in (x, y, kLever_m yaw), the others held.
  double least_in_plane = 0.0;
};

/// In: constraints in axes of the map with the sensor as origin, weight = 1 / sigma [1/m], the
/// sensor's orientation in the map. Out: the sums over constraints of J J^T and r J with
///   r = weight (n . p - offset),  J = weight (n, p x n),
/// turned into the sensor's frame.
ScanInformation scan_information(const std::vector<PlaneConstraint>& constraints,
                                 const Eigen::Matrix3d& R_map_sensor);

/// What a scan determines of the pose: the covariance and the status follow from it.
struct KnownInformation {
  Matrix6 information = Matrix6::Zero();  ///< in the sensor's frame
  bool is_complete = true;                ///< there is some about every direction
};

/// The part of that information which errors of normals do not explain.
///
/// Along a tunnel each normal leans at random, and many of them make a direction look known. With
///   N = sum of J_t J_t^T,  J_t = weight (t, p x t),  t: the normal's tilt,
/// the expected part of it, a direction u of information a = u^T (sum J J^T) u is known above
///   b = 2 u^T N u + kMismatchedShare sum of weight^2
/// and keeps the share (a / b - 1) / 5, between 0 and 1, of its information.
KnownInformation known_information(const std::vector<PlaneConstraint>& constraints,
                                   const Eigen::Matrix3d& R_map_sensor);

struct VelocityInformation;

/// The expected state as a prior, to be combined with the information of a scan.
class ExpectedState {
 public:
  explicit ExpectedState(const MotionState& expected);

  /// Moves pose and velocity of `state` by a Gauss-Newton step towards the most likely state:
  ///   minimise  e^T P^-1 e / 2  of the error e against the expected state
  ///             plus the information of the scan about the change of the pose.
  /// The velocity follows by its correlation with the pose, and by `velocity` if that is given.
  void improve(MotionState& state, const ScanInformation& scan,
               const VelocityInformation* velocity = nullptr) const;

  /// The covariance after a scan of this KnownInformation::information. Poses use all of the scan's
  /// information, since errors of normals usually explain little of it.
  Matrix12 covariance(const Matrix6& known) const;

  /// The expected state given the pose, with the velocity that leads there.
  MotionState given(const Pose& T_map_sensor) const;

 private:
  /// Puts the velocity, and the acceleration that it means, into the state.
  void put_velocity(const Vector6& velocity, MotionState& state) const;

  MotionState expected_;
  Matrix12 information_;
};

}  // namespace hqslam::slam
