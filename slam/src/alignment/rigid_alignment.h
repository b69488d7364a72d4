#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "alignment/motion_state.h"
#include "hqslam/core/pose.h"

namespace hqslam::slam {

/// One linear constraint on a point of the scan: its distance from a plane.
///   residual = weight * (normal . (R p + t) - offset_m)
/// A planar feature gives one; an edge feature gives two, with normals perpendicular to the line.
struct PlaneConstraint {
  Eigen::Vector3d point_m;  ///< p, in the moving frame
  /// In the fixed frame; of unit length, or shorter to use a part of its information.
  Eigen::Vector3d normal;
  double offset_m = 0.0;  ///< of the plane: normal . q for any point q of it
  double weight = 1.0;
  /// Standard deviation of the normal, along the direction in which it is largest.
  Eigen::Vector3d tilt = Eigen::Vector3d::Zero();
  double time_offset_s = 0.0;  ///< of the point's capture from the stamp; only in the map
};

/// An edge feature: two planes that meet in its line, perpendicular to each other.
using EdgeConstraints = std::array<PlaneConstraint, 2>;
/// The constraints of the point `point_m` to the line through `on_line_m` along unit `direction`.
EdgeConstraints edge_constraints(const Eigen::Vector3d& point_m, const Eigen::Vector3d& on_line_m,
                                 const Eigen::Vector3d& direction, double weight);

/// The constraints found for all features, in one list.
struct ConstraintList {
  std::vector<PlaneConstraint> all;
  int edges = 0;
  int planes = 0;
  int ground = 0;  ///< number of planes of the ground; only in the map

  void add(const std::vector<std::optional<EdgeConstraints>>& found);
  void add(const std::vector<std::optional<PlaneConstraint>>& found);
};

/// The estimated motion, split in two as in LeGO-LOAM:
///   T = translation (x, y, z) after R = Rz(yaw) Ry(pitch) Rx(roll),
/// in plane x, y [m] and yaw [rad], then out of plane z [m], roll and pitch [rad].
using MotionParameters = Vector6;
Pose pose_of(const MotionParameters& parameters);
MotionParameters parameters_of(const Pose& pose);

/// The residuals of all constraints with analytic Jacobians, in the form that Ceres expects:
/// parameter block 0 are the parameters in plane, block 1 those out of plane. Jacobians may be
/// null, or one of them.
///
///   d residual / d t = weight n;   d residual / d angle = weight n . (dR/dangle p).
void evaluate(const std::vector<PlaneConstraint>& constraints, double const* const* parameters,
              double* residuals, double** jacobians);

enum class FreeParameters { kInPlane, kOutOfPlane, kAll };

/// Levenberg-Marquardt (Ceres) from `start`, at most `max_steps` steps; the other parameters are
/// held. Never leaves a worse estimate than `start`.
MotionParameters align(const std::vector<PlaneConstraint>& constraints,
                       const MotionParameters& start, FreeParameters free, int max_steps);

/// Smallest observable share; simulated: 0.008 and more in streets, 0.001 along an endless
/// corridor.
inline constexpr double kMinObservableShare = 0.003;

/// Lever arm that converts angles to lengths where directions of motion are compared.
inline constexpr double kLever_m = 10.0;

/// Directions of motion about which the constraints have no information.
///
/// In: constraints whose points are about the origin, the estimated parameters. With angles scaled
/// by a lever of 10 m, so that all parameters are lengths, the eigenvalues of J^T J / (sum of
/// weight^2) are the share of the constraints with information about a direction. Directions with
/// less than kMinObservableShare are degenerate. Source: Zhang, Kaess & Singh, ICRA 2016. Differs
/// from LeGO-LOAM: every direction is tested (not in the order of eigenvalues up to the first good
/// one), by a share, which does not depend on the number of points.
struct Observability {
  int degenerate_directions = 0;
  /// The share of each direction, rising, and the directions in scaled units, a column each: (x, y,
  /// z, 10 m times rotation about x, y, z).
  Vector6 share = Vector6::Zero();
  Matrix6 direction = Matrix6::Zero();
  /// Projects a change of (x, y, z, roll, pitch, yaw) onto the observable directions.
  Matrix6 projection = Matrix6::Identity();
};
Observability observability(const std::vector<PlaneConstraint>& constraints, FreeParameters free);
/// In: J^T J, with angles scaled, and the sum of weight^2.
Observability observability(Matrix6 information, double total, FreeParameters free);

/// `start` changed towards `end` in the observable directions only.
MotionParameters without_unobservable(const MotionParameters& start, const MotionParameters& end,
                                      const Observability& observability);

}  // namespace hqslam::slam
