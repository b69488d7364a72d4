#pragma once

#include "city.h"

namespace hqslam::sim {

/// A house on the sheet. Side 0 of the lot is that of small v, then counter-clockwise.
struct HouseLot {
  Eigen::AlignedBox2d sheet_m;
  int front = 0;                       ///< side with the door
  std::array<bool, 4> open_to_view{};  ///< sides that get windows; the others are blank
  bool detached = false;               ///< low, with a gabled roof
};
inline HouseLot detached_lot(const Eigen::AlignedBox2d& sheet_m, int front) {
  return {sheet_m, front, {true, true, true, true}, true};
}
/// The rectangle between two opposite corners.
inline Eigen::AlignedBox2d box_of(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return {a.cwiseMin(b), a.cwiseMax(b)};
}

void add_house(City& city, const HouseLot& lot, Random& random);

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

// The contents of blocks that are level with the street.

/// A field: at its edges a hedge, a fence or telegraph poles here and there, few trees on it, on
/// some a farm.
void add_field(City& city, const Block& block, Random& random);
/// Long smooth walls at the street, cut off at the corners; trees behind them.
void add_smooth_walls(City& city, const Block& block, Random& random);
/// Two rows of cars back to back, their noses to the aisles of axis 0.
void add_parking_rows(City& city, const Block& block, Random& random);

}  // namespace hqslam::sim
