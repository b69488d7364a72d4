#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "hqslam/sim/drive.h"
#include "ray_scene.h"

namespace hqslam::sim {

/// The truth at a place outdoors: the lowest surface below `point_m` plus 50 m, and whether a
/// standing surface reaches into the upright column about it. World frame; the scene must have no
/// actors. Nothing where there is no ground within 100 m.
std::optional<TruePlace> true_place(const RayScene& scene, const Eigen::Vector3d& point_m,
                                    const UprightColumn& column);

/// Distance of a point from the nearest true surface, metres; infinity where it exceeds `reach_m`.
/// True surfaces are those of standing things and those seen through their glass (curtains, rooms
/// and seats), which exist only as seen from a place: for a point that one of `places_m` sees
/// through glass, the distance along that line of sight counts too. World frame; the scene must
/// have no actors.
double distance_to_true_surface_m(const RayScene& scene,
                                  const std::vector<Eigen::Vector3d>& places_m,
                                  const Eigen::Vector3d& point_m, double reach_m);

}  // namespace hqslam::sim
