#pragma once

#include <Eigen/Geometry>
#include <vector>

namespace hqslam::sim {

/// The way of somebody who walks on floors and stairs: a polyline with rounded corners, as control
/// points of a uniform cubic B-spline every quarter of a metre. After half a second they start and
/// then keep their pace. A longer polyline begins with the same way as a shorter one.
class WalkingPath {
 public:
  WalkingPath(const std::vector<Eigen::Vector3d>& waypoints_m, double pace_mps);
  /// The walker's feet, upright, x forward.
  Eigen::Isometry3d T_world_walker(double time_s) const;

 private:
  double pace_mps_;
  std::vector<Eigen::Vector3d> control_m_;
};

}  // namespace hqslam::sim
