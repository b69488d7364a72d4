#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <set>
#include <vector>

#include "style.h"

namespace hqslam::sim {

/// Smooth hills: a sum of plane waves, whose height and slope have a closed form.
///   height(p) = sum_k a_k sin(w_k . p + phase_k),  sum_k a_k |w_k| <= slope_bound
class Terrain {
 public:
  Terrain(std::uint64_t seed, double slope_bound);
  double height_m(const Eigen::Vector2d& plane_m) const;
  /// d height / d (x, y).
  Eigen::Vector2d slope(const Eigen::Vector2d& plane_m) const;
  /// The point of the terrain at `plane_m`, lifted.
  Eigen::Vector3d ground(const Eigen::Vector2d& plane_m, double lift_m) const;
  /// Frame of something that stands on the terrain: x along `heading_rad`, z along the terrain's
  /// normal to first order.
  ///   pitch = -atan(slope along x), roll = atan(slope along y)
  Eigen::Isometry3d frame(const Eigen::Vector2d& plane_m, double heading_rad) const;

 private:
  struct Wave {
    Eigen::Vector2d wave_vector_rad_per_m;
    double amplitude_m;
    double phase_rad;
  };
  std::array<Wave, 6> waves_;
};

/// The plan of the city is drawn on a sheet (u, v) where streets are straight and blocks are
/// rectangles; the sheet is then bent into the plane (x, y) and laid over the terrain. A street of
/// axis 0 is the line u = position_m, one of axis 1 the line v = position_m.
struct Street {
  double position_m = 0.0;
  double half_width_m = 5.5;   ///< from the middle to the kerb
  double lane_offset_m = 1.7;  ///< of the middle of a lane; traffic keeps right
  bool parking = true;         ///< room for parked cars along both kerbs
  bool tree_lined = false;
};

/// Whether blocks of this kind end in a kerb and a sidewalk; the others are level with the street.
constexpr bool has_sidewalk(BlockKind kind) { return kind < BlockKind::kField; }

/// The land between streets, up to the kerbs.
struct Block {
  Eigen::AlignedBox2d sheet_m;
  BlockKind kind = BlockKind::kRowHouses;
  std::uint64_t seed = 0;
};

/// A wave that bends the sheet: (x, y) = (u, v) + sum_k a_k sin(w_k . (u, v) + phase_k).
struct BendingWave {
  Eigen::Vector2d wave_vector_rad_per_m;
  Eigen::Vector2d amplitude_m;
  double phase_rad;
};

/// The stretch of a street of axis 0 between two neighbouring crossings.
struct Stretch {
  int street = 0;
  int from_crossing = 0;  ///< index of the crossing street with the smaller position
  auto operator<=>(const Stretch&) const = default;
};

struct Layout {
  std::array<std::vector<Street>, 2> streets;  ///< by axis, in the order of position_m
  std::set<Stretch> closed;                    ///< stretches that are built over
  std::vector<Block> blocks;
  Eigen::AlignedBox2d rim_m;  ///< the whole city on the sheet; open land begins beyond
  std::array<BendingWave, 3> bending;
  Terrain terrain;

  /// A point of the sheet in the plane.
  Eigen::Vector2d plane(const Eigen::Vector2d& sheet_m) const;
  /// A point of the sheet on the terrain, lifted.
  Eigen::Vector3d ground(const Eigen::Vector2d& sheet_m, double lift_m) const {
    return terrain.ground(plane(sheet_m), lift_m);
  }
  /// The heading in the plane of a direction (u, v) of the sheet.
  double heading_rad(const Eigen::Vector2d& sheet_m, const Eigen::Vector2d& direction) const;
};

/// Height of blocks above the street.
constexpr double kKerbHeight_m = 0.14;
constexpr double kSidewalkWidth_m = 3.0;
constexpr double kCornerRadius_m = 4.0;

Layout make_layout(const CityStyle& style, std::uint64_t seed);

}  // namespace hqslam::sim
