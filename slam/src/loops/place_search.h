#pragma once

#include <Eigen/Core>
#include <vector>

#include "hqslam/core/pose.h"

namespace hqslam::slam {

/// Where to look for a sensor, seen from above: all shifts and turns up to these about a pose.
struct SearchWindow {
  double yaw_rad = 0.0;  ///< in the middle of the window
  double max_shift_m = 8.0;
  double max_turn_rad = 0.1;
};

/// A pose in the plane at which the points fit, and which share of them does.
struct PlacedPoints {
  Pose T_place_sensor = Pose::Identity();
  double share = 0.0;
};

/// Finds where points fit best into what is known about a place, without a start near the answer.
///
/// In: upright structure of the place (frame of the place, z up), points about the sensor that
/// stand up from the ground (sensor frame), a window. Out: the best pose in the plane and the best
/// one at least 3 m from it, if there is one; best first. The structure is drawn from above as a
/// grid of 0.5 m; every pose of the window is tried and scored by how many points fall on drawn
/// cells, beside them half. Source: Olson, Real-time correlative scan matching, ICRA 2009.
/// Differs from it: one resolution, since the window is small.
///
/// The first registers from many metres away, where matching nearest points does not; the second
/// shows whether the place looks like its own neighbourhood.
std::vector<PlacedPoints> search_place(const std::vector<Eigen::Vector3f>& structure_m,
                                       const std::vector<Eigen::Vector3f>& points_m,
                                       const SearchWindow& window);

/// Of the points of a map those that belong to edges or walls: in columns of 0.5 m that reach over
/// at least 0.8 m. The ground, however steep, does not.
std::vector<Eigen::Vector3f> upright_structure_m(const std::vector<Eigen::Vector3f>& points_m);

}  // namespace hqslam::slam
