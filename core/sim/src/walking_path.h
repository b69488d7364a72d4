#pragma once

#include <Eigen/Core>
#include <vector>

namespace hqslam::sim {

/// The way of somebody who walks on floors and stairs: a polyline with rounded corners, as control
/// points of a uniform cubic B-spline every quarter of a metre. After half a second they start and
/// then keep their pace. A longer polyline begins with the same way as a shorter one.
class WalkingPath {
 public:
  struct State {
    Eigen::Vector3d feet_m;
    double heading_rad = 0.0;
  };
  WalkingPath(const std::vector<Eigen::Vector3d>& waypoints_m, double pace_mps);
  State at_time(double time_s) const;

 private:
  double pace_mps_;
  std::vector<Eigen::Vector3d> control_m_;
};

}  // namespace hqslam::sim
