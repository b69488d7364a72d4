#pragma once

#include <Eigen/Geometry>

#include "terrain.h"

namespace hqslam::sim {

/// Frame of something that stands on the terrain at `plane_m` and looks along `heading_rad`:
/// x forward, z along the terrain's normal to first order.
///   pitch = -atan(slope along x), roll = atan(slope along y)
Eigen::Isometry3d on_ground(const Terrain& terrain, const Eigen::Vector2d& plane_m,
                            double heading_rad);

}  // namespace hqslam::sim
