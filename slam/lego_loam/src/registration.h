#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "hqslam/core/pose.h"

namespace hqslam::lego_loam {

/// A pose as the two steps of odometry split it: R = Rz(yaw) Ry(pitch) Rx(roll), t = (x, y, z).
struct PoseParameters {
  Eigen::Vector3d out_of_plane = Eigen::Vector3d::Zero();  ///< z [m], roll, pitch [rad]
  Eigen::Vector3d in_plane = Eigen::Vector3d::Zero();      ///< x, y [m], yaw [rad]
};
/// The share s of a steady motion: R(s roll, s pitch, s yaw), s t.
Pose pose_of(const PoseParameters& parameters, double s = 1.0);
PoseParameters parameters_of(const Pose& pose);

/// A point of the scan and the plane through q with unit normal n on which the pose should bring
/// it: minimized is weight n . (R(s) p + s t - q).
struct Constraint {
  Eigen::Vector3d p;
  Eigen::Vector3d q;
  Eigen::Vector3d n;
  double s = 1.0;
  double weight = 1.0;
};
using Constraints = std::vector<Constraint>;

/// Adds a correspondence with weight 1 - fall d / sqrt(|p|), d its distance at the present pose, if
/// that is above 0.1.
void add_plane(Constraint plane, const Pose& T, double fall, Constraints& constraints);
/// The same for a line through q along u, as two planes that meet in it at a right angle; the
/// weight is 1 - fall d.
void add_line(Constraint line, const Eigen::Vector3d& u, const Pose& T, double fall,
              Constraints& constraints);
inline constexpr int kPerLine = 2;

enum class Free { kOutOfPlane, kInPlane, kAll };
struct Schedule {
  int searches;
  int steps_per_search;
  int min_constraints;
  double converged_m;
  double converged_deg;
};
/// The constraints at a pose, in the search of this number.
using FindConstraints = std::function<Constraints(const PoseParameters& pose, int search)>;

/// Searches correspondences and takes steps of Levenberg-Marquardt (Ceres) by turns until a search
/// moves the pose by less than the schedule says. Parameters that are not free are held. Returns
/// how many constraints the last search found; 0 where these were too few, and the pose stays.
int align(PoseParameters& pose, Free free, const Schedule& schedule, const FindConstraints& find);

}  // namespace hqslam::lego_loam
