#pragma once

#include <Eigen/Core>
#include <vector>

#include "ray_scene.h"

namespace hqslam::sim {

/// Distance of a point from the nearest true surface, metres; infinity where it exceeds `reach_m`.
/// True surfaces are those of standing things and those seen through their glass (curtains, rooms
/// and seats), which exist only as seen from a place: for a point that one of `places_m` sees
/// through glass, the distance along that line of sight counts too. World frame; the scene must
/// have no actors.
double distance_to_true_surface_m(const RayScene& scene,
                                  const std::vector<Eigen::Vector3d>& places_m,
                                  const Eigen::Vector3d& point_m, double reach_m);

}  // namespace hqslam::sim
