#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "mesh.h"

namespace hqslam::sim {

/// From a point to the nearest point of a triangle, metres.
double distance_to_triangle_m(const Eigen::Vector3d& point_m, const Eigen::Vector3d& a_m,
                              const Eigen::Vector3d& b_m, const Eigen::Vector3d& c_m);
/// The same for a triangle of a mesh, in the mesh's frame.
double distance_to_triangle_m(const TriangleMesh& mesh, std::uint32_t triangle,
                              const Eigen::Vector3d& point_m);

}  // namespace hqslam::sim
