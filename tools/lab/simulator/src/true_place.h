#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "hqslam/sim/drive.h"
#include "ray_scene.h"

namespace hqslam::sim {

/// What there is at a place out of doors: the lowest surface below `point_m` plus 50 m, and whether
/// any surface of what stands still comes into the upright column about it. World frame; no one may
/// move in the scene. Nothing where there is no ground within 100 m.
std::optional<TruePlace> true_place(const RayScene& scene, const Eigen::Vector3d& point_m,
                                    const UprightColumn& column);

/// From a point to the nearest true surface, metres; infinity where that is farther than `reach_m`.
/// True are the surfaces of what stands still, and what their glass shows: curtains, rooms and
/// seats, which exist only as seen from a place. Of a point that is not on a surface and that one
/// of `places_m` sees through glass, the distance along that line of sight counts too. World frame;
/// no one may move in the scene.
double distance_to_true_surface_m(const RayScene& scene,
                                  const std::vector<Eigen::Vector3d>& places_m,
                                  const Eigen::Vector3d& point_m, double reach_m);

}  // namespace hqslam::sim
