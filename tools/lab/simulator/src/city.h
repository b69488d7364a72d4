#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "layout.h"
#include "mesh.h"
#include "prototype.h"
#include "random.h"

namespace hqslam::sim {

struct Placement {
  int prototype = 0;
  Eigen::Affine3d T_world_prototype = Eigen::Affine3d::Identity();
  std::uint8_t shade = 128;  ///< of the paint or the clothes
};

/// Everything that stands still, and the shapes of the actors.
struct Scenery {
  TriangleMesh fixed;
  std::vector<TriangleMesh> prototypes;
  std::vector<Placement> placements;
};

/// The scenery of a layout.
struct City : Scenery {
  Layout layout;
  double parked_car_share = 0.0;  ///< of the places to park
};

City make_city(const CityStyle& style, std::uint64_t seed);

/// The surfaces that one drives and walks on: the streets, of each block its kerbs, its sidewalk
/// and what is inside, and the open land around the city.
void add_streets(City& city);
void add_block_ground(City& city, const Block& block);
void add_open_land(City& city);
/// Adds the contents of a block, by its kind.
void fill_block(City& city, const Block& block);
/// Adds the furniture of the sidewalks and the cars at the kerb.
void furnish_sidewalks(City& city, const Block& block);

/// The kerb of one side of a block.
struct BlockSide {
  Eigen::Vector2d from_m;
  Eigen::Vector2d along;
  Eigen::Vector2d inwards;
  double length_m = 0.0;
  Eigen::Vector2d at(double along_m, double inwards_m) const {
    return from_m + along_m * along + inwards_m * inwards;
  }
};
/// The side of small v first, then counter-clockwise.
std::array<BlockSide, 4> sides_of(const Eigen::AlignedBox2d& sheet_m);

/// Upright on the ground, lifted by `lift_m`; x points in the direction `along` of the sheet.
Eigen::Isometry3d frame_at(const City& city, const Eigen::Vector2d& sheet_m,
                           const Eigen::Vector2d& along, double lift_m);
/// The frame beside a kerb, x along it.
inline Eigen::Isometry3d frame_at(const City& city, const BlockSide& side, double along_m,
                                  double inwards_m, double lift_m) {
  return frame_at(city, side.at(along_m, inwards_m), side.along, lift_m);
}

// Things on the ground at a place on the sheet, lifted.
void place_tree(City& city, const Eigen::Vector2d& sheet_m, double lift_m, Random& random);
void place_bush(City& city, const Eigen::Vector2d& sheet_m, double lift_m, Random& random);
void park_car(City& city, const Eigen::Vector2d& sheet_m, double heading_rad, Random& random);

/// A random place in the rectangle, `margin_m` away from its sides.
Eigen::Vector2d draw_inside(const Eigen::AlignedBox2d& sheet_m, double margin_m, Random& random);
/// Places `count` trees or bushes at random in the rectangle.
void scatter(City& city, decltype(&place_tree) place, int count, const Eigen::AlignedBox2d& sheet_m,
             double margin_m, double lift_m, Random& random);

}  // namespace hqslam::sim
