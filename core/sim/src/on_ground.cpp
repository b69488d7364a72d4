#include "on_ground.h"

#include <cmath>

#include "hqslam/core/pose.h"

namespace hqslam::sim {

Eigen::Isometry3d on_ground(const Terrain& terrain, const Eigen::Vector2d& plane_m,
                            double heading_rad) {
  const Eigen::Vector2d slope = terrain.slope(plane_m);
  const Eigen::Vector2d forward(std::cos(heading_rad), std::sin(heading_rad));
  const Eigen::Vector2d left(-forward.y(), forward.x());
  return pose_from_xyz_rpy({plane_m.x(), plane_m.y(), terrain.height_m(plane_m)},
                           std::atan(slope.dot(left)), -std::atan(slope.dot(forward)), heading_rad);
}

}  // namespace hqslam::sim
