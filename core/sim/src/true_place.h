#pragma once

#include <Eigen/Core>
#include <optional>

#include "hqslam/sim/drive.h"
#include "ray_scene.h"

namespace hqslam::sim {

/// What there is at a place out of doors: the lowest surface below `point_m` plus 50 m, and whether
/// any surface of what stands still comes into the upright column about it. World frame; no one may
/// move in the scene. Nothing where there is no ground within 100 m.
std::optional<TruePlace> true_place(const RayScene& scene, const Eigen::Vector3d& point_m,
                                    const UprightColumn& column);

}  // namespace hqslam::sim
