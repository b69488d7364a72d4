#pragma once

#include <Eigen/Core>

namespace hqslam::sim {

/// From a point to the nearest point of a triangle, metres.
double distance_to_triangle_m(const Eigen::Vector3d& point_m, const Eigen::Vector3d& a_m,
                              const Eigen::Vector3d& b_m, const Eigen::Vector3d& c_m);

}  // namespace hqslam::sim
