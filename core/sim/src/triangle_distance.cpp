#include "triangle_distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace hqslam::sim {

namespace {

double squared_distance_to_edge_m2(const Eigen::Vector3d& point_m, const Eigen::Vector3d& from_m,
                                   const Eigen::Vector3d& to_m) {
  const Eigen::Vector3d along_m = to_m - from_m;
  const double length_m2 = along_m.squaredNorm();
  const double fraction =
      length_m2 > 0.0 ? std::clamp((point_m - from_m).dot(along_m) / length_m2, 0.0, 1.0) : 0.0;
  return (point_m - from_m - fraction * along_m).squaredNorm();
}

}  // namespace

// Where the point's foot on the plane lies inside the triangle, seen from all three edges, it is
// the nearest; otherwise the nearest point lies on an edge.
double distance_to_triangle_m(const Eigen::Vector3d& point_m, const Eigen::Vector3d& a_m,
                              const Eigen::Vector3d& b_m, const Eigen::Vector3d& c_m) {
  const Eigen::Vector3d normal = (b_m - a_m).cross(c_m - a_m);
  const auto is_inside = [&](const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m) {
    return (to_m - from_m).cross(point_m - from_m).dot(normal) >= 0.0;
  };
  const double length = normal.norm();
  if (length > 0.0 && is_inside(a_m, b_m) && is_inside(b_m, c_m) && is_inside(c_m, a_m)) {
    return std::abs(normal.dot(point_m - a_m)) / length;
  }
  return std::sqrt(std::min({squared_distance_to_edge_m2(point_m, a_m, b_m),
                             squared_distance_to_edge_m2(point_m, b_m, c_m),
                             squared_distance_to_edge_m2(point_m, c_m, a_m)}));
}

}  // namespace hqslam::sim
