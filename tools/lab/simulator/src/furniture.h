#pragma once

#include "city.h"

namespace hqslam::sim {

// Single things, upright in `frame` (x along the street, y away from it).

void add_lamp(TriangleMesh& mesh, const Eigen::Isometry3d& frame);
void add_traffic_sign(TriangleMesh& mesh, const Eigen::Isometry3d& frame, Random& random);
void add_traffic_light(TriangleMesh& mesh, const Eigen::Isometry3d& frame);
void add_bench(TriangleMesh& mesh, const Eigen::Isometry3d& frame);
void add_bin(TriangleMesh& mesh, const Eigen::Isometry3d& frame, Random& random);

// Things that follow a line of the sheet over the terrain.

void add_hedge(City& city, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m,
               double height_m, Random& random);
void add_picket_fence(City& city, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m,
                      Random& random);
/// Posts with two rails, as around a paddock.
void add_rail_fence(City& city, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m);
void add_garden_wall(City& city, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m,
                     double height_m, Surface surface);
/// An overhead wire that sags between two lamps.
void add_wire(TriangleMesh& mesh, const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace hqslam::sim
