#pragma once

#include <Eigen/Core>
#include <vector>

#include "hqslam/core/pose.h"

namespace hqslam::slam {

/// A pose in the plane, and the share of the points that fit there.
struct PlacedPoints {
  Pose T_place_sensor = Pose::Identity();
  double share = 0.0;
};

/// Finds the pose at which points fit best into a place, without a start near it.
///
/// In: upright structure of the place (frame of the place, z up), points above the ground about the
/// sensor (sensor frame), the yaw in the middle of the window. Out: the best pose in the plane and
/// the best one at least 3 m from it, if there is one; best first. The structure is projected from
/// above onto a grid of 0.5 m; every pose of the window, shifts up to 8 m and rotations up to 0.1
/// rad, is scored by the number of points on occupied cells, plus half of those beside them.
/// Source: Olson, Real-time correlative scan matching, ICRA 2009. Differs from it: one resolution,
/// since the window is small.
///
/// The first is right many metres away, where matching nearest points fails; the second shows
/// whether the place is similar to its own neighbourhood.
std::vector<PlacedPoints> search_place(const std::vector<Eigen::Vector3f>& structure_m,
                                       const std::vector<Eigen::Vector3f>& points_m,
                                       double yaw_rad);

/// The points of a map on edges or walls: in columns of 0.5 m whose points span at least 0.8 m in
/// height, more than steep ground.
std::vector<Eigen::Vector3f> upright_structure_m(const std::vector<Eigen::Vector3f>& points_m);

}  // namespace hqslam::slam
