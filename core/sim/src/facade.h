#pragma once

#include <Eigen/Core>

#include "mesh.h"
#include "random.h"

namespace hqslam::sim {

/// What the walls of one house have in common.
struct FacadeStyle {
  double storey_height_m = 3.0;
  int storeys = 3;
  double bay_width_m = 2.8;  ///< one window per bay and storey
  double window_width_m = 1.2;
  double window_height_m = 1.5;
  double recess_m = 0.2;       ///< of windows behind the wall
  double balcony_share = 0.1;  ///< of the bays above the ground storey
  bool shop = false;           ///< large windows on the ground storey
  Surface wall;
};

/// A wall from foot `from` to foot `to` (seen from outside: left to right), vertical.
struct WallPlace {
  Eigen::Vector2d from;
  Eigen::Vector2d to;
  double foot_z_m = 0.0;   ///< where the wall leaves the ground, below the lowest point
  double floor_z_m = 0.0;  ///< of the ground storey
};

/// A wall with recessed windows, a door and balconies.
void add_facade(TriangleMesh& mesh, const WallPlace& place, const FacadeStyle& style,
                bool with_door, Random& random);

/// A wall without openings, up to the eaves.
void add_blank_wall(TriangleMesh& mesh, const WallPlace& place, const FacadeStyle& style);

}  // namespace hqslam::sim
